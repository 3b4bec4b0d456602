/// What the movie reader and writer share of libav (FFmpeg 5.1): ownership, messages, inputs, pixel formats. The only
/// header that includes libav's; nothing outside movie_*.cpp may include it.
///
/// libav never writes to stderr: its messages are kept, the last one a thread, and quoted in our one-line errors.
/// Only local files are opened: no other protocol, also not from inside a play list.
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

/// Redirects libav's messages; call before anything else of libav. Cheap when repeated.
void silence();

/// Sets `seen` whenever this codec reports an error; to be called before the codec is opened. Uses its `opaque`.
void watch_errors(AVCodecContext& codec, std::atomic<bool>& seen);

/// "reason (libav's last message on this thread)" for an error code; forgets the message.
std::string reason(int error);

/// Opens a movie and finds its streams. FrameError: missing, empty, not a movie, truncated before its index.
Input open_input(const std::filesystem::path& path);

/// The moving picture (not cover art) of an input, or nullptr.
AVStream* video_stream(AVFormatContext* input);

/// "file:PATH", so that no name is taken for a protocol.
std::string url(const std::filesystem::path& path);

/// Geometry of the planar family nearest to `pixel_format` (depth, planes, chroma ratios; nothing else is set).
/// Every code of integer formats has its own value in the family. Formats that are not integer samples (float, Bayer,
/// XYZ, one bit) map to 16-bit RGB, through swscale.
MovieFormat family_of(AVPixelFormat pixel_format);

/// libav's planar format that holds `format`'s codes, or AV_PIX_FMT_NONE if it has none of that depth.
AVPixelFormat planar_format(const MovieFormat& format);

/// True if every code of `format` can be stored in `pixel_format` as it is.
bool holds(AVPixelFormat pixel_format, const MovieFormat& format);

/// Copies samples of a decoded picture into `frame.planes`; frame.format tells the family.
void read_planes(const AVFrame& picture, MovieFrame& frame);

/// Copies the planes that `format` has (frame.format, or it less alpha) into an allocated picture that holds() them.
void write_planes(const MovieFrame& frame, const MovieFormat& format, AVFrame& picture);

/// Converts `from` into the allocated `to` (same size) by swscale, precisely and reproducibly. FrameError naming
/// `what`.
void convert(const AVFrame& from, AVFrame& to, const std::string& what);

}  // namespace eikonal::libav
