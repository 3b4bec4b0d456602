/// Reads a movie frame by frame, in presentation order, in its own codes (movie_frame.h). Frames count from 1.
///
/// Nothing is scaled, dropped or doubled: every decoded frame comes with its own time stamp, also at variable rate.
/// A frame whose data are damaged (the decoder had to conceal), and a movie that ends before the length its header
/// states, are errors. Decoding uses the threads that the program allows oneTBB; the codes do not depend on them.
///
/// Frames come as they are stored. rotation() tells how players turn them; interlaced() that their rows belong to two
/// times, which no warp can treat right.
///
/// Failures: FrameError naming file, frame and reason. One reader is used by one thread at a time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "warp/image/movie_frame.h"

namespace eikonal {

/// num / den; 0/1 means unknown.
struct Rational {
    std::int64_t num = 0, den = 1;
    double value() const { return static_cast<double>(num) / static_cast<double>(den); }
};

class MovieReader {
  public:
    /// Opens the movie and decodes up to its first whole frame, so that every property is known; the errors of damaged
    /// ones before it come from next().
    explicit MovieReader(std::filesystem::path path);
    MovieReader(MovieReader&&) noexcept;
    MovieReader& operator=(MovieReader&&) noexcept;
    ~MovieReader();

    const std::filesystem::path& path() const;
    const MovieFormat& format() const;
    /// Nominal rate in frames a second; the mean for variable rate.
    Rational fps() const;
    /// Seconds a unit of MovieFrame::pts and duration.
    Rational time_base() const;
    /// As the container states it, or computed from its stated length; nothing if it states neither. For progress and
    /// for checking ranges: what next() returns is the truth.
    std::optional<std::int64_t> frame_count() const;
    /// Whether the container counts its frames; else frame_count() is an estimate from the length, if any.
    bool count_is_exact() const;
    /// Degrees clockwise by which players turn the picture: 0, 90, 180 or 270.
    int rotation() const;
    bool interlaced() const;

    /// The next frame; false at the end. After an error the frame counts as read: calling again goes on with the next.
    bool next(MovieFrame& frame);
    /// Passes over one frame, decoded but not converted; false at the end. Damaged frames are passed over silently.
    bool skip();
    /// Whether nothing can follow: next() has returned false or told that the movie is cut off.
    bool at_end() const;
    /// Number of the frame that next() will return.
    int next_number() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Frames that a movie's file really holds: its packets, which are read and not decoded. FrameError: unreadable,
/// without pictures, cut off within a frame. Nothing for Theora, whose frames that repeat the one before leave no
/// packet.
std::optional<std::int64_t> count_frames(const std::filesystem::path& path);

}  // namespace eikonal
