#include "warp/image/movie_writer.h"

extern "C" {
#include <libavutil/timecode.h>
}

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <stdexcept>

#include "noise/base/error.h"
#include "warp/image/atomic_file.h"
#include "warp/image/movie_codec.h"
#include "warp/image/movie_copy.h"

namespace eikonal {

namespace {

/// The finest clock for a source whose time stamps are kept [1/s]. Encoders and containers have no use for a finer one.
constexpr int kFinestClock = 6553500;

AVRational to_libav(Rational value) {
    AVRational result{};
    av_reduce(&result.num, &result.den, value.num, value.den, INT32_MAX);
    return result;
}

/// Containers and codecs that count frames instead of keeping time stamps.
bool counts_frames(const AVOutputFormat* container, AVRational time_base) {
    const std::string_view name = container->name;
    return name == "avi" || name == "mxf" || name == "mpeg" || time_base.den > kFinestClock;
}

void advance_time_code(AVDictionary** metadata, AVRational rate, int frames) {
    const AVDictionaryEntry* entry = av_dict_get(*metadata, "timecode", nullptr, 0);
    AVTimecode code;
    if (!entry || frames == 0 || av_timecode_init_from_string(&code, rate, entry->value, nullptr) < 0) return;
    char text[AV_TIMECODE_STR_SIZE];
    av_dict_set(metadata, "timecode", av_timecode_make_string(&code, text, frames), 0);
}

}  // namespace

struct MovieWriter::State {
    enum class Timing { Source, Part, Counted };  ///< the source's times; a part from time 0; one frame after the other

    std::filesystem::path path;
    MovieSettings settings;
    AtomicFile file;
    MovieFormat format;
    libav::Encoder encoder;
    std::unique_ptr<libav::StreamCopier> copier;
    libav::Output output;
    AVStream* stream = nullptr;
    libav::Frame picture = libav::make_frame(), planar = libav::make_frame();
    libav::Packet packet = libav::make_packet();
    Timing timing = Timing::Counted;
    AVRational frame_base{1, 25};  ///< unit of the frames' time stamps [s]
    std::int64_t origin = 0;       ///< pts of time 0 [frame_base]
    std::int64_t counted = 0;      ///< next time stamp of Timing::Counted [frame_base]
    std::int64_t end = 0;          ///< end of the last frame in the source's time [frame_base]
    std::int64_t last_pts = AV_NOPTS_VALUE;
    std::map<std::int64_t, std::int64_t> durations;  ///< durations of the frames within the encoder, by time stamp
    std::int64_t frames = 0;

    State(const std::filesystem::path& target, const MovieFormat& movie_format, MovieSettings movie_settings)
        : path(target), settings(std::move(movie_settings)), file(target), format(movie_format) {
        libav::silence();
    }

    FrameError error(int code, const std::string& what) const {
        return FrameError(fmt::format("{}: {}: {}", path.string(), what, libav::reason(code)));
    }

    void choose_timing(const MovieReader& source) {
        const std::vector<int>& chosen = settings.frames;
        const auto count = source.frame_count();
        timing = Timing::Source;
        if (chosen.empty()) return;
        const bool contiguous = static_cast<std::size_t>(chosen.back() - chosen.front()) + 1 == chosen.size();
        const bool whole = contiguous && chosen.front() == 1 && count && chosen.back() >= *count;
        if (!whole) timing = contiguous ? Timing::Part : Timing::Counted;
    }

    void open_like(const MovieReader& source) {
        std::error_code ignored;
        if (std::filesystem::equivalent(source.path(), path, ignored))
            throw UserError(fmt::format("{}: output and input are the same file; choose another name", path.string()));
        choose_timing(source);
        copier = std::make_unique<libav::StreamCopier>(source.path());
        const AVStream& video = copier->video();
        libav::EncoderRequest request;
        request.source_codec = video.codecpar->codec_id;
        request.source_profile = video.codecpar->profile;
        request.source_bit_rate = video.codecpar->bit_rate;
        request.pixel_aspect =
            video.sample_aspect_ratio.num > 0 ? video.sample_aspect_ratio : video.codecpar->sample_aspect_ratio;
        request.field_order = video.codecpar->field_order;
        frame_base = to_libav(source.time_base());
        open(request, to_libav(source.fps()));
        copier->describe_file(*output);
        copier->describe_video(*stream);
        if (timing == Timing::Counted)
            copier->drop_streams(settings.warn, "because the chosen frames have gaps");
        else
            copier->add_streams(*output, settings.warn);
        if (!settings.frames.empty())
            advance_time_code(&stream->metadata, encoder.context->framerate, settings.frames.front() - 1);
        const std::int64_t start = copier->input().start_time;
        if (timing == Timing::Source) {
            const std::int64_t first = start == AV_NOPTS_VALUE ? 0 : start;
            origin = av_rescale_q(first, AV_TIME_BASE_Q, frame_base);
            copier->start_at(first, AV_TIME_BASE_Q, false);
            copier->copy_chapters(*output, first);
        }
        write_header();
    }

    void open_sequence(Rational fps) {
        if (fps.num <= 0 || fps.den <= 0)
            throw UserError(fmt::format("{}: {}/{} frames a second is no rate; give a positive one", path.string(),
                                        fps.num, fps.den));
        const AVRational rate = to_libav(fps);
        frame_base = av_inv_q(rate);
        libav::EncoderRequest request;
        request.pixel_aspect = av_d2q(format.pixel_aspect, 10000);
        open(request, rate);
        write_header();
    }

    /// Opens encoder and muxer, up to the header.
    void open(libav::EncoderRequest& request, AVRational rate) {
        request.container = libav::find_container(path);
        request.format = format;
        request.frame_rate = rate.num > 0 ? rate : AVRational{25, 1};
        request.time_base = counts_frames(request.container, frame_base) ? av_inv_q(request.frame_rate) : frame_base;
        encoder = libav::open_encoder(request, settings, path);

        const std::string address = libav::url(file.temporary());
        AVFormatContext* context = nullptr;
        if (avformat_alloc_output_context2(&context, request.container, nullptr, address.c_str()) < 0)
            throw std::bad_alloc();
        output.reset(context);
        output->flags |= AVFMT_FLAG_BITEXACT;
        stream = avformat_new_stream(output.get(), nullptr);
        if (!stream || avcodec_parameters_from_context(stream->codecpar, encoder.context.get()) < 0)
            throw std::bad_alloc();
        stream->time_base = encoder.context->time_base;
        stream->avg_frame_rate = request.frame_rate;
        stream->sample_aspect_ratio = request.pixel_aspect;
        const bool quicktime = has_brand("mp4") || has_brand("mov");
        if (quicktime && encoder.context->codec_id == AV_CODEC_ID_HEVC)
            stream->codecpar->codec_tag = MKTAG('h', 'v', 'c', '1');  // all players know this tag

        picture->interlaced_frame = libav::interlaced(request.field_order) ? 1 : 0;
        picture->top_field_first = libav::top_field_first(request.field_order) ? 1 : 0;
        picture->format = encoder.context->pix_fmt;
        allocate(*picture, encoder.stored);
        if (!encoder.exact) {
            planar->format = libav::planar_format(format);
            allocate(*planar, format);
        }
    }

    bool has_brand(std::string_view name) const { return std::string_view(output->oformat->name) == name; }

    void allocate(AVFrame& frame, const MovieFormat& described) const {
        frame.width = format.width;
        frame.height = format.height;
        frame.color_range = static_cast<AVColorRange>(described.range);
        frame.color_primaries = static_cast<AVColorPrimaries>(described.primaries);
        frame.color_trc = static_cast<AVColorTransferCharacteristic>(described.transfer);
        frame.colorspace = static_cast<AVColorSpace>(described.matrix);
        frame.chroma_location = static_cast<AVChromaLocation>(described.siting);
        if (av_frame_get_buffer(&frame, 0) < 0) throw std::bad_alloc();
    }

    void write_header() {
        if (const int opened = avio_open(&output->pb, output->url, AVIO_FLAG_WRITE); opened < 0)
            throw error(opened, "cannot be written");
        AVDictionary* options = nullptr;
        if (has_brand("mp4") || has_brand("mov")) av_dict_set(&options, "movflags", "faststart", 0);
        const int written = avformat_write_header(output.get(), &options);
        av_dict_free(&options);
        if (written < 0) throw error(written, "cannot be started");
    }

    /// A frame's time stamp in the encoder's time base.
    std::int64_t stamp(const MovieFrame& frame) {
        const std::int64_t duration = std::max<std::int64_t>(1, frame.duration);
        if (frames == 0 && timing == Timing::Part) {
            origin = frame.pts;
            copier->start_at(origin, frame_base, true);
        }
        const std::int64_t time = timing == Timing::Counted ? counted : frame.pts - origin;
        counted += copier ? duration : 1;
        end = frame.pts + duration;
        std::int64_t pts = av_rescale_q(time, frame_base, encoder.context->time_base);
        if (last_pts != AV_NOPTS_VALUE) pts = std::max(pts, last_pts + 1);
        last_pts = pts;
        durations[pts] =
            copier ? std::max<std::int64_t>(1, av_rescale_q(duration, frame_base, encoder.context->time_base)) : 1;
        return pts;
    }

    void write(const MovieFrame& frame) {
        if (frame.format.width != format.width || frame.format.height != format.height ||
            frame.format.depth != format.depth || frame.format.rgb != format.rgb || frame.format.gray != format.gray)
            throw std::logic_error("a frame differs from its movie's format");
        const std::int64_t pts = stamp(frame);
        if (av_frame_make_writable(picture.get()) < 0) throw std::bad_alloc();
        if (encoder.exact) {
            libav::write_planes(frame, encoder.stored, *picture);
        } else {
            libav::write_planes(frame, format, *planar);
            libav::convert(*planar, *picture, path.string());
        }
        picture->pts = pts;
        picture->pict_type = AV_PICTURE_TYPE_NONE;
        ++frames;
        encode(picture.get());
        if (copier && timing != Timing::Counted) copy_until(end);
    }

    void encode(const AVFrame* frame) {
        if (const int sent = avcodec_send_frame(encoder.context.get(), frame); sent < 0)
            throw error(sent, fmt::format("frame {} cannot be encoded", frames));
        while (true) {
            const int received = avcodec_receive_packet(encoder.context.get(), packet.get());
            if (received == AVERROR(EAGAIN) || received == AVERROR_EOF) return;
            if (received < 0) throw error(received, "cannot be encoded");
            if (const auto known = durations.find(packet->pts); known != durations.end()) {
                packet->duration = known->second;
                durations.erase(known);
            }
            packet->stream_index = stream->index;
            av_packet_rescale_ts(packet.get(), encoder.context->time_base, stream->time_base);
            if (const int written = av_interleaved_write_frame(output.get(), packet.get()); written < 0)
                throw error(written, "cannot be written");
        }
    }

    void copy_until(std::optional<std::int64_t> time) {
        if (const int copied = copier->copy_until(*output, time, frame_base); copied < 0)
            throw error(copied, "cannot be written");
    }

    void finish() {
        if (frames == 0) throw FrameError(fmt::format("{}: no frame was written; no movie is made", path.string()));
        encode(nullptr);
        if (copier && timing == Timing::Source) copy_until({});
        if (copier)
            if (const int ended = copier->finish(*output); ended < 0) throw error(ended, "cannot be written");
        if (const int closed = av_write_trailer(output.get()); closed < 0) throw error(closed, "cannot be written");
        avio_flush(output->pb);
        if (const int failed = output->pb->error; failed < 0) throw error(failed, "cannot be written");
        if (const int closed = avio_closep(&output->pb); closed < 0) throw error(closed, "cannot be written");
        file.commit();
    }
};

bool is_movie_name(const std::filesystem::path& path) {
    try {
        return libav::find_container(path) != nullptr;
    } catch (const UserError&) {
        return false;
    }
}

MovieFormat sequence_format(const std::filesystem::path& movie, int width, int height, int source_bits,
                            double pixel_aspect, const std::string& codec) {
    MovieFormat format;
    format.width = width;
    format.height = height;
    format.pixel_aspect = pixel_aspect;
    format.primaries = format.transfer = format.matrix = AVCOL_SPC_BT709;
    const bool deep = source_bits > 8;
    if (codec.starts_with("ffv1")) {
        format.rgb = true;
        format.range = CodeRange::Full;
        format.matrix = AVCOL_SPC_RGB;
        format.depth = deep ? 16 : 8;
        return format;
    }
    format.range = CodeRange::Limited;
    format.siting = ChromaSiting::Left;
    std::string extension = movie.extension().string();
    for (char& c : extension) c = static_cast<char>(c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
    const bool delivery = extension == ".mp4" || extension == ".m4v" || extension == ".avi";
    const bool intermediate = codec.starts_with("prores") || codec.starts_with("dnx");
    format.depth = intermediate || (deep && !delivery) ? 10 : 8;
    const bool even = width % 2 == 0 && height % 2 == 0;
    format.log2_chroma_w = even || intermediate ? 1 : 0;
    format.log2_chroma_h = even && !intermediate ? 1 : 0;
    return format;
}

MovieWriter::MovieWriter(const std::filesystem::path& path, const MovieReader& source, MovieSettings settings) {
    libav::find_container(path);
    state_ = std::make_unique<State>(path, source.format(), std::move(settings));
    state_->open_like(source);
}

MovieWriter::MovieWriter(const std::filesystem::path& path, const MovieFormat& format, Rational fps,
                         MovieSettings settings) {
    libav::find_container(path);
    state_ = std::make_unique<State>(path, format, std::move(settings));
    state_->open_sequence(fps);
}

MovieWriter::MovieWriter(MovieWriter&&) noexcept = default;
MovieWriter& MovieWriter::operator=(MovieWriter&&) noexcept = default;
MovieWriter::~MovieWriter() = default;

void MovieWriter::write(const MovieFrame& frame) {
    state_->write(frame);
}
void MovieWriter::finish() {
    state_->finish();
}

}  // namespace eikonal
