#include "warp/image/movie_codec.h"

extern "C" {
#include <libavutil/opt.h>
}

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "noise/base/error.h"

namespace eikonal::libav {

namespace {

/// The way in which an encoder takes its quality.
enum class Quality { Crf, Quantiser, Profile, Lossless };

struct KnownEncoder {
    AVCodecID codec;
    const char* name;
    Quality quality;
    double value;         ///< visually lossless crf or quantiser
    double best, worst;   ///< range of that value. Unused for Profile and Lossless.
    const char* options;  ///< "key=value,key=value"
};

/// Every codec that we write. libx264 works without mbtree. The fast code of mbtree reads memory that was never set, so
/// its bytes differ from run to run.
constexpr std::array kEncoders{
    KnownEncoder{AV_CODEC_ID_H264, "libx264", Quality::Crf, 15, 0, 51, "preset=fast,x264-params=mbtree=0"},
    KnownEncoder{AV_CODEC_ID_HEVC, "libx265", Quality::Crf, 15, 0, 51,
                 "preset=fast,x265-params=log-level=none:pools=4"},
    KnownEncoder{AV_CODEC_ID_VP9, "libvpx-vp9", Quality::Crf, 15, 0, 63, "deadline=good,cpu-used=4,row-mt=1"},
    KnownEncoder{AV_CODEC_ID_VP8, "libvpx", Quality::Crf, 5, 0, 63, "deadline=good,cpu-used=2,b=100M"},
    KnownEncoder{AV_CODEC_ID_AV1, "libaom-av1", Quality::Crf, 15, 0, 63, "cpu-used=6,row-mt=1"},
    KnownEncoder{AV_CODEC_ID_MPEG4, "mpeg4", Quality::Quantiser, 2, 1, 31, ""},
    KnownEncoder{AV_CODEC_ID_MPEG2VIDEO, "mpeg2video", Quality::Quantiser, 2, 1, 31, ""},
    KnownEncoder{AV_CODEC_ID_THEORA, "libtheora", Quality::Quantiser, 10, 10, 0, ""},
    KnownEncoder{AV_CODEC_ID_MJPEG, "mjpeg", Quality::Quantiser, 2, 1, 31, "strict=unofficial"},
    KnownEncoder{AV_CODEC_ID_PRORES, "prores_ks", Quality::Profile, 0, 0, 0, "vendor=apl0"},
    KnownEncoder{AV_CODEC_ID_DNXHD, "dnxhd", Quality::Profile, 0, 0, 0, ""},
    KnownEncoder{AV_CODEC_ID_FFV1, "ffv1", Quality::Lossless, 0, 0, 0, "level=3,slices=4,slicecrc=1"},
    KnownEncoder{AV_CODEC_ID_FFVHUFF, "ffvhuff", Quality::Lossless, 0, 0, 0, ""},
    KnownEncoder{AV_CODEC_ID_HUFFYUV, "huffyuv", Quality::Lossless, 0, 0, 0, ""},
    KnownEncoder{AV_CODEC_ID_UTVIDEO, "utvideo", Quality::Lossless, 0, 0, 0, ""},
    KnownEncoder{AV_CODEC_ID_MAGICYUV, "magicyuv", Quality::Lossless, 0, 0, 0, ""},
    KnownEncoder{AV_CODEC_ID_QTRLE, "qtrle", Quality::Lossless, 0, 0, 0, ""},
    KnownEncoder{AV_CODEC_ID_PNG, "png", Quality::Lossless, 0, 0, 0, ""},
    KnownEncoder{AV_CODEC_ID_V210, "v210", Quality::Lossless, 0, 0, 0, ""},
    KnownEncoder{AV_CODEC_ID_RAWVIDEO, "rawvideo", Quality::Lossless, 0, 0, 0, ""},
};

const KnownEncoder* find_known(AVCodecID codec) {
    const auto* found =
        std::find_if(kEncoders.begin(), kEncoders.end(), [&](const auto& e) { return e.codec == codec; });
    return found == kEncoders.end() ? nullptr : found;
}

const KnownEncoder& find_named(const std::string& name) {
    for (const KnownEncoder& known : kEncoders)
        if (name == known.name || name == avcodec_get_name(known.codec)) return known;
    std::string names;
    for (const KnownEncoder& known : kEncoders)
        names += std::string(names.empty() ? "" : ", ") + avcodec_get_name(known.codec);
    throw UserError(fmt::format("`codec`: '{}' is unknown; allowed: {}", name, names));
}

/// The encoder that the user names. The container must be able to hold its codec.
const KnownEncoder& find_allowed(const std::string& name, const AVOutputFormat* container,
                                 const std::filesystem::path& path) {
    const KnownEncoder& wanted = find_named(name);
    if (avformat_query_codec(container, wanted.codec, FF_COMPLIANCE_NORMAL) != 0) return wanted;
    std::string held, others;
    for (const KnownEncoder& known : kEncoders)
        if (accepts(container, known.codec))
            held += (held.empty() ? "" : ", ") + std::string(avcodec_get_name(known.codec));
    for (const char* other : {".mov", ".mkv"})
        if (accepts(av_guess_format(nullptr, other, nullptr), wanted.codec))
            others += (others.empty() ? "" : " or ") + std::string(other);
    throw UserError(fmt::format("`codec` {}: '{}' cannot hold it, {} holds {}; write {}", name, path.string(),
                                path.extension().string(), held, others));
}

/// Throws UserError for a quality that the codec does not have.
void check_quality(const KnownEncoder& known, const MovieSettings& settings) {
    if (!settings.quality) return;
    const char* name = avcodec_get_name(known.codec);
    if (known.best == known.worst)
        throw UserError(fmt::format("`quality`: {} {}; leave it out or name another `codec`", name,
                                    known.quality == Quality::Lossless ? "is lossless" : "has a quality of its own"));
    if (*settings.quality < std::min(known.best, known.worst) || *settings.quality > std::max(known.best, known.worst))
        throw UserError(fmt::format("`quality`: {:g} is none of {}, which takes {:g} (best) to {:g}", *settings.quality,
                                    name, known.best, known.worst));
}

/// The encoders to try, best first.
std::vector<const KnownEncoder*> candidates(const EncoderRequest& request, const MovieSettings& settings,
                                            const std::filesystem::path& path) {
    if (!settings.codec.empty()) return {&find_allowed(settings.codec, request.container, path)};
    const MovieFormat& format = request.format;
    std::vector<AVCodecID> order{request.source_codec};
    if (std::string_view(request.container->name) == "avi") {
        const bool plain =
            format.depth == 8 && !format.rgb && !format.alpha && format.log2_chroma_w == 1 && format.log2_chroma_h == 1;
        if (plain) order.push_back(AV_CODEC_ID_MPEG4);
        order.push_back(AV_CODEC_ID_FFV1);
    }
    for (const AVCodecID codec : {AV_CODEC_ID_H264, AV_CODEC_ID_VP9, AV_CODEC_ID_THEORA, AV_CODEC_ID_DNXHD,
                                  AV_CODEC_ID_MPEG4, AV_CODEC_ID_MPEG2VIDEO, AV_CODEC_ID_MJPEG})
        order.push_back(codec);
    const bool ogg =
        std::string_view(request.container->name).starts_with("og");  // its muxer names no codecs and refuses most
    std::vector<const KnownEncoder*> result;
    for (const AVCodecID codec : order) {
        const KnownEncoder* known = find_known(codec);
        if (!known || std::find(result.begin(), result.end(), known) != result.end()) continue;
        const bool kept = codec == request.source_codec && !ogg &&
                          avformat_query_codec(request.container, codec, FF_COMPLIANCE_NORMAL) == AVERROR_PATCHWELCOME;
        if (accepts(request.container, codec) || kept) result.push_back(known);
    }
    return result;
}

/// H.264 and H.265 encoders refuse subsampled formats whose cells do not fill the picture.
bool size_fits(AVCodecID codec, const MovieFormat& family, const MovieFormat& format) {
    if (codec != AV_CODEC_ID_H264 && codec != AV_CODEC_ID_HEVC) return true;
    return format.width % (1 << family.log2_chroma_w) == 0 && format.height % (1 << family.log2_chroma_h) == 0;
}

/// The pixel format for the encoder, and the planes of the frame that it stores.
AVPixelFormat choose_pixel_format(const AVCodec& codec, const MovieFormat& format, Encoder& encoder) {
    std::vector<AVPixelFormat> offered;
    for (const AVPixelFormat* p = codec.pix_fmts; p && *p != AV_PIX_FMT_NONE; ++p)
        if (size_fits(codec.id, family_of(*p), format)) offered.push_back(*p);
    const AVPixelFormat planar = planar_format(format);
    if (!codec.pix_fmts) offered.push_back(planar);
    MovieFormat opaque = format;
    opaque.alpha = false;
    const bool offers_alpha = std::any_of(offered.begin(), offered.end(), [](auto p) { return family_of(p).alpha; });
    for (const MovieFormat& wanted : {format, opaque}) {
        if (format.alpha && !wanted.alpha && offers_alpha) break;  // conversion is better than the loss of alpha
        for (const AVPixelFormat p : offered)
            if (holds(p, wanted)) {
                encoder.stored = wanted;
                return p;
            }
    }
    offered.push_back(AV_PIX_FMT_NONE);
    const AVPixelFormat nearest = avcodec_find_best_pix_fmt_of_list(offered.data(), planar, format.alpha, nullptr);
    if (nearest == AV_PIX_FMT_NONE) return nearest;
    const MovieFormat family = family_of(nearest);
    encoder.exact = false;
    encoder.stored = family;
    encoder.stored.width = format.width;
    encoder.stored.height = format.height;
    encoder.stored.pixel_aspect = format.pixel_aspect;
    encoder.stored.primaries = format.primaries;
    encoder.stored.transfer = format.transfer;
    encoder.stored.range = format.range;
    encoder.stored.matrix = format.matrix;
    encoder.stored.siting = format.siting;
    const bool to_rgb = family.rgb && !format.rgb, from_rgb = !family.rgb && format.rgb;
    if (to_rgb || std::string_view(av_get_pix_fmt_name(nearest)).starts_with("yuvj"))
        encoder.stored.range = CodeRange::Full;
    if (to_rgb) encoder.stored.matrix = 0;
    if (from_rgb) {
        encoder.stored.range = CodeRange::Limited;
        encoder.stored.matrix = format.width >= 1280 || format.height > 576 ? AVCOL_SPC_BT709 : AVCOL_SPC_SMPTE170M;
        encoder.stored.siting = ChromaSiting::Left;
    }
    return nearest;
}

void set_quality(AVCodecContext& context, AVDictionary** options, const KnownEncoder& known,
                 const EncoderRequest& request, const MovieSettings& settings) {
    const double value = settings.quality.value_or(known.value);
    switch (known.quality) {
        case Quality::Crf:
            av_dict_set(options, "crf", fmt::format("{}", value).c_str(), 0);
            break;
        case Quality::Quantiser:
            context.flags |= AV_CODEC_FLAG_QSCALE;
            context.global_quality = static_cast<int>(value * FF_QP2LAMBDA);
            if (known.codec != AV_CODEC_ID_THEORA) context.qmin = 1;
            break;
        case Quality::Profile:
            if (known.codec == AV_CODEC_ID_DNXHD) {
                const bool deep = context.pix_fmt != AV_PIX_FMT_YUV422P;
                const bool known_profile = request.source_codec == known.codec && request.source_profile > 0;
                context.profile = known_profile ? request.source_profile
                                  : deep        ? FF_PROFILE_DNXHR_HQX
                                                : FF_PROFILE_DNXHR_HQ;
                if (context.profile == FF_PROFILE_DNXHD) context.bit_rate = request.source_bit_rate;
            } else if (request.source_codec == known.codec && request.source_profile >= 0) {
                context.profile = request.source_profile;
                av_dict_set_int(options, "profile", request.source_profile, 0);
            }
            break;
        case Quality::Lossless:
            break;
    }
}

/// The encoder's time base. It is the request's, except for codecs that count frames or have too coarse a clock.
AVRational time_base_for(AVCodecID codec, const EncoderRequest& request) {
    constexpr int kMpeg4LargestTick = 65535;
    const bool coarse = codec == AV_CODEC_ID_MPEG4 && request.time_base.den > kMpeg4LargestTick;
    const bool counts = codec == AV_CODEC_ID_MPEG2VIDEO || codec == AV_CODEC_ID_THEORA;
    return counts || coarse ? av_inv_q(request.frame_rate) : request.time_base;
}

/// Codes frames as two fields, if the codec can. The container states the field order in any case.
void set_fields(AVCodecContext& context, const EncoderRequest& request) {
    if (!interlaced(request.field_order)) return;
    context.field_order = request.field_order;
    switch (context.codec_id) {
        case AV_CODEC_ID_H264:
            if (context.height % 4 == 0) context.flags |= AV_CODEC_FLAG_INTERLACED_DCT;  // x264 takes no other height
            break;
        case AV_CODEC_ID_MPEG2VIDEO:
        case AV_CODEC_ID_MPEG4:
            context.flags |= AV_CODEC_FLAG_INTERLACED_DCT | AV_CODEC_FLAG_INTERLACED_ME;
            break;
        case AV_CODEC_ID_PRORES:
        case AV_CODEC_ID_DNXHD:
            context.flags |= AV_CODEC_FLAG_INTERLACED_DCT;
            break;
        default:
            break;
    }
}

void describe_loss(const Encoder& encoder, const EncoderRequest& request, const KnownEncoder& known,
                   const MovieSettings& settings, const std::filesystem::path& path) {
    if (!settings.warn) return;
    const auto tell = [&](const std::string& what) { settings.warn(fmt::format("{}: {}", path.string(), what)); };
    const MovieFormat &from = request.format, &to = encoder.stored;
    if (from.alpha && !to.alpha)
        tell(fmt::format("alpha is dropped, {} as encoded here holds none; prores or ffv1 keep it", known.name));
    if (encoder.exact) return;
    const bool odd = !size_fits(known.codec, from, from);
    const bool richer = to.depth >= from.depth && to.rgb == from.rgb && to.gray == from.gray &&
                        to.alpha == from.alpha && to.log2_chroma_w <= from.log2_chroma_w &&
                        to.log2_chroma_h <= from.log2_chroma_h;
    if (richer && !odd) return;
    tell(fmt::format("pixels are stored as {}, not {}: {}", av_get_pix_fmt_name(encoder.context->pix_fmt),
                     av_get_pix_fmt_name(planar_format(from)),
                     odd ? fmt::format("{} takes subsampled colour in even sizes only, not {}x{}", known.name,
                                       from.width, from.height)
                         : fmt::format("{} cannot hold that; ffv1 in .mkv keeps every code", known.name)));
}

}  // namespace

bool interlaced(AVFieldOrder order) {
    return order != AV_FIELD_UNKNOWN && order != AV_FIELD_PROGRESSIVE;
}
bool top_field_first(AVFieldOrder order) {
    return order == AV_FIELD_TT || order == AV_FIELD_TB;
}

const AVOutputFormat* find_container(const std::filesystem::path& path) {
    const AVOutputFormat* container = av_guess_format(nullptr, path.filename().c_str(), nullptr);
    const bool usable = container && !(container->flags & AVFMT_NOFILE) && container->video_codec != AV_CODEC_ID_NONE &&
                        std::any_of(kEncoders.begin(), kEncoders.end(),
                                    [&](const auto& known) { return accepts(container, known.codec); });
    if (!usable)
        throw UserError(
            fmt::format("{}: \"{}\" is no movie container that can be written; use .mp4, .mov, .mkv, .webm, "
                        ".avi, .m4v, .ts, .mxf or .ogv",
                        path.string(), path.extension().string()));
    return container;
}

bool accepts(const AVOutputFormat* container, AVCodecID codec) {
    return avformat_query_codec(container, codec, FF_COMPLIANCE_NORMAL) == 1;
}

Encoder open_encoder(const EncoderRequest& request, const MovieSettings& settings, const std::filesystem::path& path) {
    std::string failures;
    for (const KnownEncoder* known : candidates(request, settings, path)) {
        const AVCodec* codec = avcodec_find_encoder_by_name(known->name);
        if (!codec) continue;
        check_quality(*known, settings);
        Encoder encoder;
        encoder.stored = request.format;
        const AVPixelFormat pixel_format = choose_pixel_format(*codec, request.format, encoder);
        if (pixel_format == AV_PIX_FMT_NONE) continue;
        encoder.context.reset(avcodec_alloc_context3(codec));
        if (!encoder.context) throw std::bad_alloc();
        AVCodecContext& context = *encoder.context;
        context.width = request.format.width;
        context.height = request.format.height;
        context.pix_fmt = pixel_format;
        context.time_base = time_base_for(codec->id, request);
        context.framerate = request.frame_rate;
        context.sample_aspect_ratio = request.pixel_aspect;
        context.color_range = static_cast<AVColorRange>(encoder.stored.range);
        context.color_primaries = static_cast<AVColorPrimaries>(encoder.stored.primaries);
        context.color_trc = static_cast<AVColorTransferCharacteristic>(encoder.stored.transfer);
        context.colorspace = static_cast<AVColorSpace>(encoder.stored.matrix);
        context.chroma_sample_location = static_cast<AVChromaLocation>(encoder.stored.siting);
        context.thread_count = kEncoderThreads;
        context.flags |= AV_CODEC_FLAG_BITEXACT;
        context.bits_per_raw_sample = encoder.stored.depth;
        if (request.container->flags & AVFMT_GLOBALHEADER) context.flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
        set_fields(context, request);
        AVDictionary* options = nullptr;
        av_dict_parse_string(&options, known->options, "=", ",", 0);
        set_quality(context, &options, *known, request, settings);
        const int opened = avcodec_open2(&context, codec, &options);
        av_dict_free(&options);
        if (opened >= 0) {
            describe_loss(encoder, request, *known, settings, path);
            return encoder;
        }
        failures += fmt::format("{}{}: {}", failures.empty() ? "" : "; ", known->name, reason(opened));
    }
    throw FrameError(fmt::format("{}: no encoder takes {}x{} frames for this container ({}); try .mkv", path.string(),
                                 request.format.width, request.format.height,
                                 failures.empty() ? "none is installed" : failures));
}

}  // namespace eikonal::libav
