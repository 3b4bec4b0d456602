/// The choice of a movie's encoder, its pixel format and its settings. movie_writer.cpp uses it.
#pragma once

#include "warp/image/movie_libav.h"
#include "warp/image/movie_writer.h"

namespace eikonal::libav {

/// Encoder threads. The number is constant, since the bytes depend on it.
inline constexpr int kEncoderThreads = 4;

struct EncoderRequest {
    const AVOutputFormat* container = nullptr;
    AVCodecID source_codec = AV_CODEC_ID_NONE;  ///< NONE for a movie made of pictures
    int source_profile = FF_PROFILE_UNKNOWN;
    std::int64_t source_bit_rate = 0;
    MovieFormat format;
    AVRational time_base{1, 25};
    AVRational frame_rate{25, 1};
    AVRational pixel_aspect{1, 1};
    AVFieldOrder field_order = AV_FIELD_UNKNOWN;  ///< of an interlaced source
};

/// Whether a field order means two instants a frame, and whether the instant of the upper row comes first (as ffmpeg
/// reads TB and BT).
bool interlaced(AVFieldOrder order);
bool top_field_first(AVFieldOrder order);

struct Encoder {
    Codec context;
    MovieFormat stored;  ///< the planes that it takes. They differ from the request's if `exact` is false.
    /// Whether its pixel format holds every code of `stored`, and `stored` is the request's format, perhaps without
    /// alpha.
    bool exact = true;
};

/// The muxer for a file name. UserError, which names the containers that can be written.
const AVOutputFormat* find_container(const std::filesystem::path& path);

/// Whether `container` can hold streams of `codec`.
bool accepts(const AVOutputFormat* container, AVCodecID codec);

/// Opens the best encoder. path: the movie's name in messages. UserError: a codec that is unknown or that the container
/// cannot hold, or a quality that the codec does not have. FrameError: no encoder can be opened.
Encoder open_encoder(const EncoderRequest& request, const MovieSettings& settings, const std::filesystem::path& path);

}  // namespace eikonal::libav
