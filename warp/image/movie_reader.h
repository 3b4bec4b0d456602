/// Reads a movie frame by frame in presentation order, in its own codes (movie_frame.h). Frames count from 1.
///
/// No frame is scaled, dropped or doubled. Every decoded frame comes with its own time stamp, at a variable rate too.
/// It is an error if a frame's data are damaged (so that the decoder had to conceal it), or if a movie ends before the
/// length in its header. Decoding uses the threads that the program allows oneTBB. The codes do not depend on their
/// number.
///
/// Frames come as they are stored. rotation() tells how players turn them. interlaced() tells that their rows belong to
/// two times, which no warp can treat correctly.
///
/// Failures: FrameError with file, frame and reason. A reader may be used by one thread at a time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "warp/image/movie_frame.h"

namespace eikonal {

/// num / den. 0/1 means unknown.
struct Rational {
    std::int64_t num = 0, den = 1;
    double value() const { return static_cast<double>(num) / static_cast<double>(den); }
};

class MovieReader {
  public:
    /// Opens the movie and decodes it up to its first whole frame, so that all properties are known. next() reports the
    /// errors of damaged frames before it.
    explicit MovieReader(std::filesystem::path path);
    MovieReader(MovieReader&&) noexcept;
    MovieReader& operator=(MovieReader&&) noexcept;
    ~MovieReader();

    const std::filesystem::path& path() const;
    const MovieFormat& format() const;
    /// Nominal rate in frames a second. For a variable rate, the mean.
    Rational fps() const;
    /// The unit of MovieFrame::pts and duration [s].
    Rational time_base() const;
    /// The number of frames that the container states, or else an estimate from its stated length. Nothing if it states
    /// neither. It serves progress and checks of ranges. Only next() tells the true number.
    std::optional<std::int64_t> frame_count() const;
    /// Whether the container counts its frames, so that frame_count() is no estimate.
    bool count_is_exact() const;
    /// Degrees clockwise by which players turn the picture: 0, 90, 180 or 270.
    int rotation() const;
    bool interlaced() const;

    /// Reads the next frame. False at the end. After an error the frame counts as read, and the next call goes on
    /// behind it.
    bool next(MovieFrame& frame);
    /// Passes over one frame, which is decoded but not converted. False at the end. Damage is not reported.
    bool skip();
    /// Whether no frame can follow: next() has returned false, or reported that the movie is cut off.
    bool at_end() const;
    /// Number of the frame that next() will return.
    int next_number() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// The number of frames that a movie's file really holds. Packets are read and counted, but not decoded. Nothing for
/// Theora, where a frame that repeats the one before has no packet. FrameError if the file is unreadable, has no
/// pictures, or is cut off within a frame.
std::optional<std::int64_t> count_frames(const std::filesystem::path& path);

}  // namespace eikonal
