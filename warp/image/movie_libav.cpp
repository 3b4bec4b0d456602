#include "warp/image/movie_libav.h"

extern "C" {
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
}

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <mutex>
#include <new>
#include <string_view>
#include <system_error>

#include "noise/base/error.h"

namespace eikonal::libav {

namespace {

thread_local std::string last_message;

void keep_message(void* object, int level, const char* format, va_list arguments) {
    if (level > AV_LOG_ERROR) return;
    const AVClass* what = object ? *static_cast<const AVClass**>(object) : nullptr;
    if (what && what->class_name && what->class_name == std::string_view("AVCodecContext"))
        if (auto* seen = static_cast<std::atomic<bool>*>(static_cast<AVCodecContext*>(object)->opaque)) *seen = true;
    std::array<char, 512> line{};
    int prefix = 0;
    av_log_format_line2(object, level, format, arguments, line.data(), static_cast<int>(line.size()), &prefix);
    std::string text(line.data());
    // libav puts the addresses of objects into messages. Keep only the text behind "[name @ 0x...] ".
    if (text.starts_with('['))
        if (const auto end = text.find("] "); end != std::string::npos) text.erase(0, end + 2);
    std::replace(text.begin(), text.end(), '\n', ' ');
    while (!text.empty() && (text.back() == ' ' || text.back() == '.')) text.pop_back();
    if (!text.empty()) last_message = text;
}

const AVPixFmtDescriptor& describe(AVPixelFormat pixel_format) {
    const AVPixFmtDescriptor* descriptor = av_pix_fmt_desc_get(pixel_format);
    if (!descriptor) throw FrameError("the stream's pixel format is unknown to libav");
    return *descriptor;
}

/// The component of a pixel format that fills plane `plane` of a frame (0 … 2 colour, 3 alpha). -1 if there is none.
int component_of(const AVPixFmtDescriptor& descriptor, const MovieFormat& format, int plane) {
    if (!format.has_plane(plane)) return -1;
    if (descriptor.flags & AV_PIX_FMT_FLAG_PAL) return plane == 3 ? 3 : 2 - plane;  // palettes are B, G, R, A
    return plane == 3 ? descriptor.nb_components - 1 : plane;
}

/// Whether av_read_image_line2 can read the format's samples, which must be integers.
bool readable(const AVPixFmtDescriptor& descriptor) {
    constexpr std::uint64_t kOther =
        AV_PIX_FMT_FLAG_BITSTREAM | AV_PIX_FMT_FLAG_HWACCEL | AV_PIX_FMT_FLAG_BAYER | AV_PIX_FMT_FLAG_FLOAT;
    if (descriptor.flags & kOther || std::string_view(descriptor.name).starts_with("xyz")) return false;
    for (int c = 0; c < descriptor.nb_components; ++c)
        if (descriptor.comp[c].depth > 16) return false;
    return true;
}

/// Repeats the bits of a code of fewer than eight bits, so that its largest value becomes 255.
std::uint16_t widen(unsigned code, int depth) {
    unsigned bits = code << (8 - depth);
    for (int done = depth; done < 8; done *= 2) bits |= bits >> done;
    return static_cast<std::uint16_t>(bits);
}

/// Whether a component lies in its own plane as plain native integers.
bool plain(const AVPixFmtDescriptor& descriptor, int component, int bytes) {
    const AVComponentDescriptor& c = descriptor.comp[component];
    return !(descriptor.flags & (AV_PIX_FMT_FLAG_BE | AV_PIX_FMT_FLAG_PAL)) && c.step == bytes && c.shift == 0 &&
           c.offset == 0 && c.depth > 8 * (bytes - 1) && c.depth >= 8;
}

}  // namespace

Frame make_frame() {
    Frame frame(av_frame_alloc());
    if (!frame) throw std::bad_alloc();
    return frame;
}

Packet make_packet() {
    Packet packet(av_packet_alloc());
    if (!packet) throw std::bad_alloc();
    return packet;
}

void silence() {
    static std::once_flag once;
    std::call_once(once, [] { av_log_set_callback(keep_message); });
}

void watch_errors(AVCodecContext& codec, std::atomic<bool>& seen) {
    codec.opaque = &seen;
}

std::string reason(int error) {
    std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
    av_strerror(error, text.data(), text.size());
    std::string result(text.data());
    if (!last_message.empty()) result += " (" + last_message + ")";
    last_message.clear();
    return result;
}

std::string url(const std::filesystem::path& path) {
    return "file:" + path.string();
}

Input open_input(const std::filesystem::path& path) {
    silence();
    last_message.clear();
    std::error_code error;
    const auto status = std::filesystem::status(path, error);
    if (!std::filesystem::exists(status))
        throw FrameError(fmt::format("{}: no such movie; check the name", path.string()));
    if (!std::filesystem::is_regular_file(status))
        throw FrameError(fmt::format("{}: not a regular file; name a movie", path.string()));
    if (std::filesystem::file_size(path, error) == 0 && !error)
        throw FrameError(fmt::format("{}: the file is empty (0 bytes); copy it again", path.string()));

    AVDictionary* options = nullptr;
    av_dict_set(&options, "protocol_whitelist", "file", 0);
    AVFormatContext* context = nullptr;
    const int opened = avformat_open_input(&context, url(path).c_str(), nullptr, &options);
    av_dict_free(&options);
    if (opened < 0)
        throw FrameError(fmt::format("{}: cannot be read as a movie: {}; it may be damaged or another kind of file",
                                     path.string(), reason(opened)));
    Input input(context);
    if (const int found = avformat_find_stream_info(context, nullptr); found < 0)
        throw FrameError(fmt::format("{}: cannot find its streams: {}", path.string(), reason(found)));
    return input;
}

AVStream* video_stream(AVFormatContext* input) {
    const int index = av_find_best_stream(input, AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
    if (index < 0) return nullptr;
    AVStream* stream = input->streams[index];
    return stream->disposition & AV_DISPOSITION_ATTACHED_PIC ? nullptr : stream;
}

MovieFormat family_of(AVPixelFormat pixel_format) {
    const AVPixFmtDescriptor& descriptor = describe(pixel_format);
    MovieFormat format;
    format.alpha = (descriptor.flags & AV_PIX_FMT_FLAG_ALPHA) != 0;
    if (!readable(descriptor)) {
        format.rgb = true;
        format.depth = 16;
        return format;
    }
    const bool palette = (descriptor.flags & AV_PIX_FMT_FLAG_PAL) != 0;
    int depth = 8;
    for (int c = 0; c < descriptor.nb_components; ++c) depth = std::max(depth, descriptor.comp[c].depth);
    format.depth = depth;
    format.rgb = palette || (descriptor.flags & AV_PIX_FMT_FLAG_RGB) != 0;
    format.gray = !palette && descriptor.nb_components <= 2;
    if (!format.rgb && !format.gray) {
        format.log2_chroma_w = descriptor.log2_chroma_w;
        format.log2_chroma_h = descriptor.log2_chroma_h;
    }
    return format;
}

AVPixelFormat planar_format(const MovieFormat& format) {
    const AVPixFmtDescriptor* descriptor = nullptr;
    while ((descriptor = av_pix_fmt_desc_next(descriptor))) {
        const AVPixelFormat id = av_pix_fmt_desc_get_id(descriptor);
        const bool planar = format.gray ? true : (descriptor->flags & AV_PIX_FMT_FLAG_PLANAR) != 0;
        const bool big = descriptor->flags & AV_PIX_FMT_FLAG_BE;
        if (planar && !big && holds(id, format) && family_of(id).alpha == format.alpha &&
            !std::string_view(descriptor->name).starts_with("yuvj"))
            return id;
    }
    return AV_PIX_FMT_NONE;
}

bool holds(AVPixelFormat pixel_format, const MovieFormat& format) {
    const AVPixFmtDescriptor* descriptor = av_pix_fmt_desc_get(pixel_format);
    if (!descriptor || !readable(*descriptor) || descriptor->flags & AV_PIX_FMT_FLAG_PAL) return false;
    if (std::string_view(descriptor->name).starts_with("yuvj") && format.range != CodeRange::Full) return false;
    const MovieFormat family = family_of(pixel_format);
    for (int c = 0; c < descriptor->nb_components; ++c)
        if (descriptor->comp[c].depth != format.depth) return false;
    return family.rgb == format.rgb && family.gray == format.gray && family.log2_chroma_w == format.log2_chroma_w &&
           family.log2_chroma_h == format.log2_chroma_h && family.alpha == format.alpha;
}

void read_planes(const AVFrame& picture, MovieFrame& frame) {
    const auto* descriptor = &describe(static_cast<AVPixelFormat>(picture.format));
    const MovieFormat& format = frame.format;
    const AVFrame* source = &picture;
    Frame converted;
    if (!readable(*descriptor)) {
        converted = make_frame();
        converted->format = planar_format(family_of(static_cast<AVPixelFormat>(picture.format)));
        converted->width = picture.width;
        converted->height = picture.height;
        if (av_frame_get_buffer(converted.get(), 0) < 0) throw std::bad_alloc();
        convert(picture, *converted, "frame");
        source = converted.get();
        descriptor = &describe(static_cast<AVPixelFormat>(source->format));
    }
    for (int plane = 0; plane < 4; ++plane) {
        auto& codes = frame.planes[static_cast<std::size_t>(plane)];
        const int component = component_of(*descriptor, format, plane);
        if (component < 0) {
            codes.clear();
            continue;
        }
        const int width = format.plane_width(plane), height = format.plane_height(plane);
        const AVComponentDescriptor& c = descriptor->comp[component];
        codes.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
        const bool palette = (descriptor->flags & AV_PIX_FMT_FLAG_PAL) != 0;
        for (int y = 0; y < height; ++y) {
            std::uint16_t* row = codes.data() + static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
            const std::uint8_t* data =
                source->data[c.plane] + static_cast<std::ptrdiff_t>(y) * source->linesize[c.plane];
            if (plain(*descriptor, component, 1))
                std::copy_n(data, width, row);
            else if (plain(*descriptor, component, 2))
                std::copy_n(reinterpret_cast<const std::uint16_t*>(data), width, row);
            else
                av_read_image_line2(row, const_cast<const std::uint8_t**>(source->data), source->linesize, descriptor,
                                    0, y, component, width, palette, 2);
            if (c.depth < 8 && !palette)
                std::transform(row, row + width, row, [&](unsigned code) { return widen(code, c.depth); });
        }
    }
}

void write_planes(const MovieFrame& frame, const MovieFormat& format, AVFrame& picture) {
    const AVPixFmtDescriptor& descriptor = describe(static_cast<AVPixelFormat>(picture.format));
    if (!(descriptor.flags & AV_PIX_FMT_FLAG_PLANAR))  // av_write_image_line2 only sets bits, so clear them first
        std::fill_n(picture.data[0], static_cast<std::ptrdiff_t>(picture.linesize[0]) * picture.height,
                    std::uint8_t{0});
    for (int plane = 0; plane < 4; ++plane) {
        const int component = component_of(descriptor, format, plane);
        if (component < 0) continue;
        const int width = format.plane_width(plane), height = format.plane_height(plane);
        const AVComponentDescriptor& c = descriptor.comp[component];
        for (int y = 0; y < height; ++y) {
            const std::uint16_t* row = frame.planes[static_cast<std::size_t>(plane)].data() +
                                       static_cast<std::size_t>(y) * static_cast<std::size_t>(width);
            std::uint8_t* data = picture.data[c.plane] + static_cast<std::ptrdiff_t>(y) * picture.linesize[c.plane];
            if (plain(descriptor, component, 1))
                std::transform(row, row + width, data, [](unsigned code) { return static_cast<std::uint8_t>(code); });
            else if (plain(descriptor, component, 2))
                std::copy_n(row, width, reinterpret_cast<std::uint16_t*>(data));
            else
                av_write_image_line2(row, picture.data, picture.linesize, &descriptor, 0, y, component, width, 2);
        }
    }
}

void convert(const AVFrame& from, AVFrame& to, const std::string& what) {
    const auto fail = [&] {
        return FrameError(fmt::format("{}: cannot convert {} to {}", what,
                                      describe(static_cast<AVPixelFormat>(from.format)).name,
                                      describe(static_cast<AVPixelFormat>(to.format)).name));
    };
    SwsContext* context = sws_alloc_context();
    if (!context) throw std::bad_alloc();
    const std::unique_ptr<SwsContext, decltype(&sws_freeContext)> owner(context, sws_freeContext);
    av_opt_set_int(context, "srcw", from.width, 0);
    av_opt_set_int(context, "srch", from.height, 0);
    av_opt_set_int(context, "dstw", to.width, 0);
    av_opt_set_int(context, "dsth", to.height, 0);
    av_opt_set_int(context, "src_format", from.format, 0);
    av_opt_set_int(context, "dst_format", to.format, 0);
    av_opt_set_int(context, "src_range", from.color_range == AVCOL_RANGE_JPEG, 0);
    av_opt_set_int(context, "dst_range", to.color_range == AVCOL_RANGE_JPEG, 0);
    av_opt_set_int(context, "sws_flags",
                   SWS_BICUBIC | SWS_ACCURATE_RND | SWS_BITEXACT | SWS_FULL_CHR_H_INT | SWS_FULL_CHR_H_INP, 0);
    if (sws_init_context(context, nullptr, nullptr) < 0) throw fail();
    const int matrix =
        to.colorspace == AVCOL_SPC_RGB || to.colorspace == AVCOL_SPC_UNSPECIFIED ? from.colorspace : to.colorspace;
    const int* coefficients = sws_getCoefficients(matrix);
    sws_setColorspaceDetails(context, coefficients, from.color_range == AVCOL_RANGE_JPEG, coefficients,
                             to.color_range == AVCOL_RANGE_JPEG, 0, 1 << 16, 1 << 16);
    if (sws_scale(context, from.data, from.linesize, 0, from.height, to.data, to.linesize) < 0) throw fail();
}

}  // namespace eikonal::libav
