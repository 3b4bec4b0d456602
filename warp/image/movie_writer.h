/// Writes movies that keep what their source had: frame count and time stamps, audio, subtitles, data and chapters
/// (copied, not coded again), colour tags, pixel aspect, rotation, field order, metadata, bit depth and chroma format.
/// Audio that the container cannot hold becomes what it can (movie_audio.h); other such streams are dropped, with a
/// warning.
///
/// Codec: the source's own where libav can encode it and the container holds it (h264, hevc, vp8, vp9, av1, mpeg2video,
/// mpeg4, theora, mjpeg, prores, dnxhd and the lossless ones), else h264, vp9 (.webm), theora (.ogv) or, in .avi, which
/// holds neither B-frames nor variable rate well, mpeg4 for 8-bit 4:2:0 and ffv1 for all else. Quality: visually
/// lossless. A codec that cannot hold the source's codes gets the nearest pixel format, with a warning that says what
/// is lost. Notably H.264 and H.265 take 4:2:0 with even sizes only; odd ones are stored as 4:4:4, rather than cropped.
///
/// The same frames give the same bytes on any machine: encoder threads are constant, no clock or version is written.
/// The file appears under its name when finish() has returned; until then, and after any error, there is none.
/// Memory does not grow with the movie: copied streams are read in step with the frames.
///
/// Failures: UserError (unknown container, codec or quality, output equal to input), FrameError (cannot be written,
/// disk full). One writer is used by one thread at a time.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "warp/image/movie_frame.h"
#include "warp/image/movie_reader.h"

namespace eikonal {

struct MovieSettings {
    std::string codec;  ///< libav's name of a codec or encoder ("hevc", "prores_ks"); empty: chosen as above
    std::optional<double>
        quality;  ///< crf, or quantiser of mpeg4, mpeg2video, mjpeg: lower is better; theora's: higher is
    /// Numbers of the source's frames that will be written, ascending; empty: all. A part in one piece starts at time 0
    /// with its own stretch of the copied streams; a part with gaps plays its frames one after the other, alone.
    std::vector<int> frames;
    std::function<void(const std::string&)> warn;  ///< told, a line each, what cannot be kept
};

/// True if the name's extension is one of a movie container that can be written.
bool is_movie_name(const std::filesystem::path& path);

/// The format for a movie made of pictures with `source_bits` a channel (16 for half, 32 for float): BT.709, limited
/// range, 4:2:0 sited left, 8 bits, as players and browsers want. 10 bits if the pictures have more than 8, but in
/// .mp4, .m4v and .avi, which are made for playing anywhere. 4:4:4 for odd sizes. Codecs prores and dnxhd: 4:2:2 10
/// bits; ffv1: RGB of 8 or 16 bits.
MovieFormat sequence_format(const std::filesystem::path& movie, int width, int height, int source_bits,
                            double pixel_aspect = 1, const std::string& codec = {});

class MovieWriter {
  public:
    /// A movie like `source`, whose file is opened once more for the streams to copy.
    MovieWriter(const std::filesystem::path& path, const MovieReader& source, MovieSettings settings = {});
    /// A movie of pictures at a constant rate; time stamps of the frames are not used. `fps` > 0.
    MovieWriter(const std::filesystem::path& path, const MovieFormat& format, Rational fps,
                MovieSettings settings = {});
    MovieWriter(MovieWriter&&) noexcept;
    MovieWriter& operator=(MovieWriter&&) noexcept;
    ~MovieWriter();

    /// Adds a frame; frames come in ascending time and have the movie's format.
    void write(const MovieFrame& frame);
    /// Flushes, closes and gives the file its name. Nothing may be written afterwards.
    void finish();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace eikonal
