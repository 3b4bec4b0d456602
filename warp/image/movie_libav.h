/// The part of libav (FFmpeg 5.1) that the movie reader and writer share: ownership, messages, inputs, pixel formats.
/// This is the only header that includes libav's. Only movie_*.cpp may include it.
///
/// libav never writes to stderr. Its last message on each thread is kept and quoted in our one-line errors. Only local
/// files are opened. No other protocol is used, not even from within a play list.
#pragma once

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/frame.h>
#include <libavutil/pixdesc.h>
}

#include <atomic>
#include <filesystem>
#include <memory>
#include <string>

#include "warp/image/movie_frame.h"

namespace eikonal::libav {

struct InputCloser {
    void operator()(AVFormatContext* context) const { avformat_close_input(&context); }
};
struct OutputCloser {
    void operator()(AVFormatContext* context) const {
        avio_closep(&context->pb);
        avformat_free_context(context);
    }
};
struct CodecCloser {
    void operator()(AVCodecContext* context) const { avcodec_free_context(&context); }
};
struct FrameFreer {
    void operator()(AVFrame* frame) const { av_frame_free(&frame); }
};
struct PacketFreer {
    void operator()(AVPacket* packet) const { av_packet_free(&packet); }
};
using Input = std::unique_ptr<AVFormatContext, InputCloser>;
using Output = std::unique_ptr<AVFormatContext, OutputCloser>;
using Codec = std::unique_ptr<AVCodecContext, CodecCloser>;
using Frame = std::unique_ptr<AVFrame, FrameFreer>;
using Packet = std::unique_ptr<AVPacket, PacketFreer>;

Frame make_frame();
Packet make_packet();

/// Redirects libav's messages. To be called before anything else of libav. Repeated calls are cheap.
void silence();

/// Sets `seen` whenever this codec reports an error. To be called before the codec is opened. Uses its `opaque`.
void watch_errors(AVCodecContext& codec, std::atomic<bool>& seen);

/// "reason (libav's last message on this thread)" for an error code. Forgets the message.
std::string reason(int error);

/// Opens a movie and finds its streams. FrameError if it is missing, empty, not a movie, or truncated before its index.
Input open_input(const std::filesystem::path& path);

/// The moving picture of an input, which is not cover art. nullptr if there is none.
AVStream* video_stream(AVFormatContext* input);

/// "file:PATH", so that no name is taken for a protocol.
std::string url(const std::filesystem::path& path);

/// The planar format nearest to `pixel_format`. Only depth, planes and chroma ratios are set. Every code of an integer
/// format has its own value in it. Formats that are not integer samples (float, Bayer, XYZ, one bit) go through swscale
/// to 16-bit RGB.
MovieFormat family_of(AVPixelFormat pixel_format);

/// libav's planar format that holds the codes of `format`. AV_PIX_FMT_NONE if libav has none of that depth.
AVPixelFormat planar_format(const MovieFormat& format);

/// Whether every code of `format` can be stored in `pixel_format` as it is.
bool holds(AVPixelFormat pixel_format, const MovieFormat& format);

/// Copies the samples of a decoded picture into frame.planes. frame.format must be set (family_of).
void read_planes(const AVFrame& picture, MovieFrame& frame);

/// Copies the planes of `format` into an allocated picture that holds() them. format: frame.format, perhaps without
/// alpha.
void write_planes(const MovieFrame& frame, const MovieFormat& format, AVFrame& picture);

/// Converts `from` into the allocated `to` of the same size by swscale, precisely and reproducibly. FrameError with
/// `what`.
void convert(const AVFrame& from, AVFrame& to, const std::string& what);

}  // namespace eikonal::libav
