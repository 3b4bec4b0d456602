/// Which encoder a movie gets, in which pixel format, with which settings. Used by movie_writer.cpp.
#pragma once

#include "warp/image/movie_libav.h"
#include "warp/image/movie_writer.h"

namespace eikonal::libav {

/// Encoder threads: constant, for the bytes depend on them.
inline constexpr int kEncoderThreads = 4;

struct EncoderRequest {
    const AVOutputFormat* container = nullptr;
    AVCodecID source_codec = AV_CODEC_ID_NONE;  ///< NONE for sequences
    int source_profile = FF_PROFILE_UNKNOWN;
    std::int64_t source_bit_rate = 0;
    MovieFormat format;
    AVRational time_base{1, 25};
    AVRational frame_rate{25, 1};
    AVRational pixel_aspect{1, 1};
    AVFieldOrder field_order = AV_FIELD_UNKNOWN;  ///< of an interlaced source
};

/// Whether a field order means two instants a frame, and that the upper row's comes first (ffmpeg reads TB and BT so).
bool interlaced(AVFieldOrder order);
bool top_field_first(AVFieldOrder order);

struct Encoder {
    Codec context;
    MovieFormat stored;  ///< the planes it takes; differs from the request's format if `exact` is false
    bool exact =
        true;  ///< its pixel format holds every code of `stored`, and that is the request's format or it less alpha
};

/// The muxer for a file name; UserError naming the containers that can be written.
const AVOutputFormat* find_container(const std::filesystem::path& path);

/// True if `container` can hold streams of `codec`.
bool accepts(const AVOutputFormat* container, AVCodecID codec);

/// Opens the best encoder; `path` is for messages. UserError: unknown codec or one that the
/// container cannot hold, a quality that it does not have. FrameError: none can be opened.
Encoder open_encoder(const EncoderRequest& request, const MovieSettings& settings, const std::filesystem::path& path);

}  // namespace eikonal::libav
