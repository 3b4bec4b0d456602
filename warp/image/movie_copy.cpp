#include "warp/image/movie_copy.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>

#include "noise/base/error.h"

namespace eikonal::libav {

namespace {

/// How much sound before a part of a movie is decoded too [s], for codecs whose packets build on earlier ones.
constexpr int kPreroll = 1;

/// Tags that describe the old file, not its contents.
bool stale(std::string_view key) {
    constexpr std::array<std::string_view, 8> kStale{"encoder",           "ENCODER",   "major_brand", "minor_version",
                                                     "compatible_brands", "vendor_id", "DURATION",    "duration"};
    return std::find(kStale.begin(), kStale.end(), key) != kStale.end() || key.starts_with("_STATISTICS") ||
           key.starts_with("BPS") || key.starts_with("NUMBER_OF_");
}

void copy_metadata(const AVDictionary* from, AVDictionary** to) {
    const AVDictionaryEntry* entry = nullptr;
    while ((entry = av_dict_get(from, "", entry, AV_DICT_IGNORE_SUFFIX)))
        if (!stale(entry->key)) av_dict_set(to, entry->key, entry->value, 0);
}

void copy_side_data(const AVStream& from, AVStream& to) {
    for (int i = 0; i < from.nb_side_data; ++i) {
        const AVPacketSideData& data = from.side_data[i];
        if (data.type == AV_PKT_DATA_CPB_PROPERTIES || data.type == AV_PKT_DATA_DOVI_CONF) continue;
        if (std::uint8_t* copy = av_stream_new_side_data(&to, data.type, data.size))
            std::memcpy(copy, data.data, data.size);
    }
}

/// Whether streams with these parameters can be copied into the container as they are.
bool can_hold(const AVOutputFormat& container, const AVCodecParameters& parameters) {
    const bool tag_fits =
        container.codec_tag && av_codec_get_id(container.codec_tag, parameters.codec_tag) == parameters.codec_id;
    switch (parameters.codec_type) {
        case AVMEDIA_TYPE_AUDIO:
            return holds_audio(container, parameters.codec_id);
        case AVMEDIA_TYPE_SUBTITLE: {
            const int answer = avformat_query_codec(&container, parameters.codec_id, FF_COMPLIANCE_NORMAL);
            return answer == 1 || answer == AVERROR_PATCHWELCOME;
        }
        // The muxer makes time code tracks again from the metadata of the video stream.
        case AVMEDIA_TYPE_DATA:
            return tag_fits && parameters.codec_tag != MKTAG('t', 'm', 'c', 'd');
        case AVMEDIA_TYPE_ATTACHMENT:
            return std::string_view(container.name) == "matroska";
        default:
            return false;
    }
}

/// Of a stream that is copied.
void copy_parameters(const AVStream& from, const AVOutputFormat& container, AVStream& to) {
    if (avcodec_parameters_copy(to.codecpar, from.codecpar) < 0) throw std::bad_alloc();
    unsigned tag = 0;
    const bool known = container.codec_tag && av_codec_get_tag2(container.codec_tag, from.codecpar->codec_id, &tag);
    if (!known || av_codec_get_id(container.codec_tag, from.codecpar->codec_tag) != from.codecpar->codec_id)
        to.codecpar->codec_tag = 0;
    to.time_base = from.time_base;
    copy_side_data(from, to);
}

std::string name_stream(const AVStream& stream) {
    const char* type = av_get_media_type_string(stream.codecpar->codec_type);
    return fmt::format("{} stream {} ({})", type ? type : "unknown", stream.index,
                       avcodec_get_name(stream.codecpar->codec_id));
}

bool is_time_code(const AVStream& stream) {
    return stream.codecpar->codec_tag == MKTAG('t', 'm', 'c', 'd');
}

}  // namespace

StreamCopier::StreamCopier(const std::filesystem::path& source) : input_(open_input(source)) {
    video_ = video_stream(input_.get());
    if (!video_) throw FrameError(fmt::format("{}: has no video stream", source.string()));
    targets_.resize(input_->nb_streams);
    for (unsigned i = 0; i < input_->nb_streams; ++i) input_->streams[i]->discard = AVDISCARD_ALL;
}

void StreamCopier::describe_video(AVStream& to) const {
    copy_metadata(video_->metadata, &to.metadata);
    copy_side_data(*video_, to);
    to.disposition = video_->disposition;
}

void StreamCopier::describe_file(AVFormatContext& to) const {
    copy_metadata(input_->metadata, &to.metadata);
}

void StreamCopier::copy_chapters(AVFormatContext& to, std::int64_t origin) const {
    if (input_->nb_chapters == 0) return;
    to.chapters = static_cast<AVChapter**>(av_calloc(input_->nb_chapters, sizeof(AVChapter*)));
    if (!to.chapters) throw std::bad_alloc();
    for (unsigned i = 0; i < input_->nb_chapters; ++i) {
        const AVChapter& from = *input_->chapters[i];
        auto* chapter = static_cast<AVChapter*>(av_mallocz(sizeof(AVChapter)));
        if (!chapter) throw std::bad_alloc();
        const std::int64_t shift = av_rescale_q(origin, AV_TIME_BASE_Q, from.time_base);
        chapter->id = from.id;
        chapter->time_base = from.time_base;
        chapter->start = std::max<std::int64_t>(0, from.start - shift);
        chapter->end = std::max(chapter->start, from.end - shift);
        copy_metadata(from.metadata, &chapter->metadata);
        to.chapters[to.nb_chapters++] = chapter;
    }
}

void StreamCopier::add_streams(AVFormatContext& to, const Warn& warn) {
    for (unsigned i = 0; i < input_->nb_streams; ++i) {
        AVStream* from = input_->streams[i];
        if (from == video_) continue;
        if (!can_hold(*to.oformat, *from->codecpar)) {
            std::string why = fmt::format("{} files cannot hold it", to.oformat->name);
            if (from->codecpar->codec_type == AVMEDIA_TYPE_AUDIO)
                targets_[i].coder = AudioTranscoder::open(*from, *to.oformat, why);
            if (warn && targets_[i].coder)
                warn(fmt::format("{} is coded again as {}, {}", name_stream(*from),
                                 avcodec_get_name(targets_[i].coder->encoder().codec_id), why));
            else if (warn && !is_time_code(*from))
                warn(fmt::format("{} is dropped, {}; .mkv or the source's container may", name_stream(*from), why));
            if (!targets_[i].coder) continue;
        }
        AVStream* stream = avformat_new_stream(&to, nullptr);
        if (!stream) throw std::bad_alloc();
        if (const auto& coder = targets_[i].coder) {
            if (avcodec_parameters_from_context(stream->codecpar, &coder->encoder()) < 0) throw std::bad_alloc();
            stream->time_base = coder->encoder().time_base;
        } else {
            copy_parameters(*from, *to.oformat, *stream);
        }
        stream->disposition = from->disposition;
        copy_metadata(from->metadata, &stream->metadata);
        from->discard = AVDISCARD_DEFAULT;
        targets_[i].stream = stream;
    }
}

void StreamCopier::drop_streams(const Warn& warn, const std::string& why) const {
    if (!warn) return;
    for (unsigned i = 0; i < input_->nb_streams; ++i)
        if (input_->streams[i] != video_ && !is_time_code(*input_->streams[i]))
            warn(fmt::format("{} is dropped, {}", name_stream(*input_->streams[i]), why));
}

void StreamCopier::start_at(std::int64_t time, AVRational time_base, bool trim) {
    origin_ = time;
    origin_base_ = time_base;
    trim_ = trim;
}

bool StreamCopier::wanted() const {
    const auto index = static_cast<std::size_t>(packet_->stream_index);
    if (index >= targets_.size() || !targets_[index].stream) return false;
    if (packet_->flags & AV_PKT_FLAG_CORRUPT) return false;
    if (!trim_ || packet_->pts == AV_NOPTS_VALUE) return true;
    const AVRational base = input_->streams[index]->time_base;
    const std::int64_t early = targets_[index].coder ? av_rescale_q(kPreroll, AVRational{1, 1}, base) : 0;
    return av_compare_ts(packet_->pts + early, base, origin_, origin_base_) >= 0;
}

int StreamCopier::copy_until(AVFormatContext& to, std::optional<std::int64_t> time, AVRational time_base) {
    const bool any = std::any_of(targets_.begin(), targets_.end(), [](const Target& t) { return t.stream; });
    while (any && !ended_) {
        if (!pending_) {
            const int read = av_read_frame(input_.get(), packet_.get());
            if (read == AVERROR(EAGAIN)) continue;
            if (read < 0) {  // the end. The reader of the pictures reports damage.
                ended_ = true;
                break;
            }
            pending_ = wanted();
            if (!pending_) {
                av_packet_unref(packet_.get());
                continue;
            }
        }
        const AVStream& from = *input_->streams[packet_->stream_index];
        const std::int64_t stamp = packet_->dts != AV_NOPTS_VALUE ? packet_->dts : packet_->pts;
        if (time && stamp != AV_NOPTS_VALUE && av_compare_ts(stamp, from.time_base, *time, time_base) >= 0) break;
        if (const int written = take_packet(to); written < 0) return written;
    }
    return 0;
}

int StreamCopier::take_packet(AVFormatContext& to) {
    const AVStream& from = *input_->streams[packet_->stream_index];
    Target& target = targets_[static_cast<std::size_t>(packet_->stream_index)];
    const std::int64_t shift = av_rescale_q(origin_, origin_base_, from.time_base);
    pending_ = false;
    if (target.coder) {
        const int coded = target.coder->code(*packet_, shift, writer(to, target));
        av_packet_unref(packet_.get());
        return coded;
    }
    if (packet_->pts != AV_NOPTS_VALUE) packet_->pts -= shift;
    if (packet_->dts != AV_NOPTS_VALUE) packet_->dts -= shift;
    return write_packet(to, target, *packet_, from.time_base);
}

int StreamCopier::write_packet(AVFormatContext& to, Target& target, AVPacket& packet, AVRational time_base) {
    av_packet_rescale_ts(&packet, time_base, target.stream->time_base);
    // Muxers refuse time stamps that do not rise. Rounding or a careless source may cause such time stamps.
    if (packet.dts != AV_NOPTS_VALUE) {
        if (target.last_dts != AV_NOPTS_VALUE) packet.dts = std::max(packet.dts, target.last_dts + 1);
        if (packet.pts != AV_NOPTS_VALUE) packet.pts = std::max(packet.pts, packet.dts);
        target.last_dts = packet.dts;
    }
    packet.stream_index = target.stream->index;
    packet.pos = -1;
    return av_interleaved_write_frame(&to, &packet);
}

AudioTranscoder::Emit StreamCopier::writer(AVFormatContext& to, Target& target) {
    return [&](AVPacket& packet) { return write_packet(to, target, packet, target.coder->encoder().time_base); };
}

int StreamCopier::finish(AVFormatContext& to) {
    for (Target& target : targets_)
        if (target.coder)
            if (const int written = target.coder->finish(writer(to, target)); written < 0) return written;
    return 0;
}

}  // namespace eikonal::libav
