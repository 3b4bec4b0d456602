/// Writes movies that keep what their source had: frame count and time stamps, audio, subtitles, data and chapters
/// (copied without coding them again), colour tags, pixel aspect, rotation, field order, metadata, bit depth and chroma
/// format. Audio that the container cannot hold is coded again (movie_audio.h). Other streams that it cannot hold are
/// dropped, with a warning.
///
/// Codec: the source's own, if libav can encode it and the container holds it (h264, hevc, vp8, vp9, av1, mpeg2video,
/// mpeg4, theora, mjpeg, prores, dnxhd and the lossless ones). Else it is h264, vp9 (.webm) or theora (.ogv). .avi
/// holds neither B-frames nor variable rates well, so there it is mpeg4 for 8-bit 4:2:0 and ffv1 for all else. Quality
/// is visually lossless. A codec that cannot hold the source's codes gets the nearest pixel format, with a warning that
/// says what is lost. H.264 and H.265 take 4:2:0 with even sizes only. Odd sizes are stored as 4:4:4 instead of being
/// cropped.
///
/// The same frames give the same bytes on any machine: the number of encoder threads is constant, and no clock or
/// version is written. The file appears under its name when finish() has returned. Before that, and after any error,
/// there is no file. Memory does not grow with the movie: copied streams are read in step with the frames.
///
/// Failures: UserError (unknown container, codec or quality, output equal to input), FrameError (cannot be written,
/// disk full). A writer may be used by one thread at a time.
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
    std::string codec;  ///< libav's name of a codec or encoder ("hevc", "prores_ks"). Empty: chosen as above.
    /// crf, or the quantiser of mpeg4, mpeg2video and mjpeg, for which lower is better. For theora, higher is better.
    std::optional<double> quality;
    /// Numbers of the source's frames that will be written, ascending. Empty: all. A part without gaps starts at time 0
    /// and has its own stretch of the copied streams. A part with gaps plays its frames one after the other, without
    /// other streams.
    std::vector<int> frames;
    std::function<void(const std::string&)> warn;  ///< gets a line about each thing that cannot be kept
};

/// Whether the name's extension is that of a movie container that can be written.
bool is_movie_name(const std::filesystem::path& path);

/// The format for a movie made of pictures. source_bits: of a channel, 16 for half and 32 for float. The format is
/// BT.709, limited range, 4:2:0 sited left, 8 bits, as players and browsers want. It has 10 bits if the pictures have
/// more than 8, except in .mp4, .m4v and .avi, which should play anywhere. Odd sizes get 4:4:4. prores and dnxhd get
/// 4:2:2 with 10 bits, and ffv1 gets RGB of 8 or 16 bits.
MovieFormat sequence_format(const std::filesystem::path& movie, int width, int height, int source_bits,
                            double pixel_aspect = 1, const std::string& codec = {});

class MovieWriter {
  public:
    /// A movie like `source`, whose file is opened a second time for the streams to copy.
    MovieWriter(const std::filesystem::path& path, const MovieReader& source, MovieSettings settings = {});
    /// A movie of pictures at a constant rate. Time stamps of the frames are not used. fps: > 0.
    MovieWriter(const std::filesystem::path& path, const MovieFormat& format, Rational fps,
                MovieSettings settings = {});
    MovieWriter(MovieWriter&&) noexcept;
    MovieWriter& operator=(MovieWriter&&) noexcept;
    ~MovieWriter();

    /// Adds a frame. Frames must come in ascending time and have the movie's format.
    void write(const MovieFrame& frame);
    /// Flushes, closes and gives the file its name. Nothing may be written afterwards.
    void finish();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace eikonal
