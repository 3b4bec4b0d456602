#include "warp/image/movie_audio.h"

extern "C" {
#include <libavutil/audio_fifo.h>
#include <libavutil/channel_layout.h>
#include <libswresample/swresample.h>
}

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <new>
#include <string_view>
#include <utility>
#include <vector>

namespace eikonal::libav {

namespace {

constexpr std::int64_t kFar = std::int64_t{1} << 60;  ///< beyond any true time stamp
constexpr int kFreeFrameSize = 1024;                  ///< samples of a packet, for encoders that take any number

struct ResamplerFreer {
    void operator()(SwrContext* context) const { swr_free(&context); }
};
struct FifoFreer {
    void operator()(AVAudioFifo* fifo) const { av_audio_fifo_free(fifo); }
};

/// Codecs that may take the place of the source's, best first.
std::vector<AVCodecID> wanted_codecs(const AVOutputFormat& container) {
    std::vector<AVCodecID> codecs;
    const AVCodecID own =
        std::string_view(container.name) == "webm" ? AV_CODEC_ID_OPUS : static_cast<AVCodecID>(container.audio_codec);
    for (const AVCodecID codec : {own, AV_CODEC_ID_OPUS, AV_CODEC_ID_AAC, AV_CODEC_ID_PCM_S16LE})
        if (codec != AV_CODEC_ID_NONE && holds_audio(container, codec)) codecs.push_back(codec);
    return codecs;
}

const AVCodec* find_encoder(AVCodecID codec) {
    if (codec == AV_CODEC_ID_OPUS)
        if (const AVCodec* best = avcodec_find_encoder_by_name("libopus")) return best;
    return avcodec_find_encoder(codec);
}

AVSampleFormat choose_format(const AVCodec& codec, AVSampleFormat source) {
    if (!codec.sample_fmts) return source;
    AVSampleFormat floating = AV_SAMPLE_FMT_NONE;
    for (const AVSampleFormat* f = codec.sample_fmts; *f != AV_SAMPLE_FMT_NONE; ++f) {
        if (av_get_packed_sample_fmt(*f) == av_get_packed_sample_fmt(source)) return *f;
        if (av_get_packed_sample_fmt(*f) == AV_SAMPLE_FMT_FLT) floating = *f;
    }
    return floating != AV_SAMPLE_FMT_NONE ? floating : codec.sample_fmts[0];
}

int choose_rate(const AVCodec& codec, int source) {
    if (!codec.supported_samplerates) return source;
    int above = 0, highest = 0;
    for (const int* rate = codec.supported_samplerates; *rate != 0; ++rate) {
        highest = std::max(highest, *rate);
        if (*rate >= source && (above == 0 || *rate < above)) above = *rate;
    }
    return above != 0 ? above : highest;
}

/// Null if the encoder does not take that layout.
Codec open_encoder(const AVCodec& codec, const AVCodecContext& source, const AVChannelLayout& layout,
                   const AVOutputFormat& container) {
    Codec encoder(avcodec_alloc_context3(&codec));
    if (!encoder || av_channel_layout_copy(&encoder->ch_layout, &layout) < 0) throw std::bad_alloc();
    encoder->sample_fmt = choose_format(codec, source.sample_fmt);
    encoder->sample_rate = choose_rate(codec, source.sample_rate);
    encoder->time_base = {1, encoder->sample_rate};
    encoder->bit_rate = std::int64_t{codec.id == AV_CODEC_ID_OPUS ? kOpusBitRate : kOtherBitRate} * layout.nb_channels;
    encoder->thread_count = 1;
    encoder->flags |= AV_CODEC_FLAG_BITEXACT;
    if (container.flags & AVFMT_GLOBALHEADER) encoder->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
    // libav's own Opus encoder counts as experimental.
    if (codec.capabilities & AV_CODEC_CAP_EXPERIMENTAL) encoder->strict_std_compliance = FF_COMPLIANCE_EXPERIMENTAL;
    if (avcodec_open2(encoder.get(), &codec, nullptr) < 0) return nullptr;
    return encoder;
}

/// The first of: the source's layout, the usual one of as many channels, stereo, mono.
Codec open_encoder(const AVCodec& codec, const AVCodecContext& source, const AVOutputFormat& container) {
    std::array<AVChannelLayout, 4> layouts{};
    av_channel_layout_copy(&layouts[0], &source.ch_layout);
    av_channel_layout_default(&layouts[1], source.ch_layout.nb_channels);
    av_channel_layout_default(&layouts[2], 2);
    av_channel_layout_default(&layouts[3], 1);
    Codec encoder;
    for (AVChannelLayout& layout : layouts) {
        if (!encoder && layout.order != AV_CHANNEL_ORDER_UNSPEC)
            encoder = open_encoder(codec, source, layout, container);
        av_channel_layout_uninit(&layout);
    }
    return encoder;
}

Codec open_decoder(const AVStream& from) {
    const AVCodec* codec = avcodec_find_decoder(from.codecpar->codec_id);
    Codec decoder(codec ? avcodec_alloc_context3(codec) : nullptr);
    if (!decoder || avcodec_parameters_to_context(decoder.get(), from.codecpar) < 0) return nullptr;
    decoder->pkt_timebase = from.time_base;  // so that the decoder cuts off padding at the right time
    decoder->thread_count = 1;
    if (avcodec_open2(decoder.get(), codec, nullptr) < 0) return nullptr;
    return decoder;
}

}  // namespace

bool holds_audio(const AVOutputFormat& container, AVCodecID codec) {
    const std::string_view name = container.name;
    const auto any_of = [&](std::initializer_list<AVCodecID> codecs) {
        return std::find(codecs.begin(), codecs.end(), codec) != codecs.end();
    };
    if (name == "mpegts")
        return any_of({AV_CODEC_ID_MP2, AV_CODEC_ID_MP3, AV_CODEC_ID_AAC, AV_CODEC_ID_AAC_LATM, AV_CODEC_ID_AC3,
                       AV_CODEC_ID_EAC3, AV_CODEC_ID_DTS, AV_CODEC_ID_OPUS, AV_CODEC_ID_S302M});
    if (name == "ogv" || name == "ogg")
        return any_of({AV_CODEC_ID_VORBIS, AV_CODEC_ID_OPUS, AV_CODEC_ID_FLAC, AV_CODEC_ID_SPEEX});
    if (name == "mxf") return any_of({AV_CODEC_ID_PCM_S16LE, AV_CODEC_ID_PCM_S24LE});
    // The QuickTime muxer knows these tags, but it refuses them in .mov or takes them for experimental.
    if (name == "mp4" && any_of({AV_CODEC_ID_FLAC, AV_CODEC_ID_TRUEHD})) return false;
    if (name == "mov" && any_of({AV_CODEC_ID_FLAC, AV_CODEC_ID_TRUEHD, AV_CODEC_ID_OPUS})) return false;
    const int answer = avformat_query_codec(&container, codec, FF_COMPLIANCE_NORMAL);
    return answer == 1 || answer == AVERROR_PATCHWELCOME;
}

struct AudioTranscoder::State {
    Codec decoder, encoder;
    AVRational source_base{};
    std::unique_ptr<SwrContext, ResamplerFreer> resampler;
    std::unique_ptr<AVAudioFifo, FifoFreer> fifo;
    Frame decoded = make_frame(), input = make_frame();
    Packet packet = make_packet();
    std::int64_t origin = 0;    ///< [source's time base]
    std::int64_t heard = 0;     ///< end of the sound that went in, from time 0 [samples of the source]
    std::int64_t next_pts = 0;  ///< time of the next sample from the fifo [samples of the encoder]
    std::int64_t lead = 0;      ///< added to the packets' times
    bool placed = false;        ///< next_pts is known
    int rate = 0;               ///< rate of the sound that the resampler takes [1/s]

    bool start_resampler(const AVFrame& frame) {
        AVChannelLayout layout{};
        if (frame.ch_layout.order == AV_CHANNEL_ORDER_UNSPEC)
            av_channel_layout_default(&layout, frame.ch_layout.nb_channels);
        else
            av_channel_layout_copy(&layout, &frame.ch_layout);
        SwrContext* context = nullptr;
        const int made =
            swr_alloc_set_opts2(&context, &encoder->ch_layout, encoder->sample_fmt, encoder->sample_rate, &layout,
                                static_cast<AVSampleFormat>(frame.format), frame.sample_rate, 0, nullptr);
        av_channel_layout_uninit(&layout);
        resampler.reset(context);
        rate = frame.sample_rate;
        return made >= 0 && swr_init(context) >= 0;
    }

    /// A source may change its format in the middle.
    bool resampler_fits(const AVFrame& frame) const {
        return resampler && frame.sample_rate == rate && frame.format == input->format &&
               frame.ch_layout.nb_channels == input->ch_layout.nb_channels;
    }

    /// Sends samples through the resampler into the fifo. Null data: the samples that the resampler holds back.
    int resample(const std::uint8_t** data, int count) {
        const int room = swr_get_out_samples(resampler.get(), count);
        if (room <= 0) return room;
        std::vector<std::uint8_t*> planes(
            static_cast<std::size_t>(std::max<int>(AV_NUM_DATA_POINTERS, encoder->ch_layout.nb_channels)));
        if (av_samples_alloc(planes.data(), nullptr, encoder->ch_layout.nb_channels, room, encoder->sample_fmt, 0) < 0)
            throw std::bad_alloc();
        int made = swr_convert(resampler.get(), planes.data(), room, data, count);
        if (made > 0 && av_audio_fifo_write(fifo.get(), reinterpret_cast<void**>(planes.data()), made) < made)
            made = AVERROR(ENOMEM);
        av_freep(static_cast<void*>(planes.data()));  // one block, from the first plane
        return std::min(made, 0);
    }

    int flush_resampler() { return resampler ? resample(nullptr, 0) : 0; }

    /// Adds `count` samples of silence in the format of `like`.
    int fill(const AVFrame& like, std::int64_t count, const Emit& emit) {
        const Frame silence = make_frame();
        silence->format = like.format;
        silence->nb_samples = static_cast<int>(std::min<std::int64_t>(count, rate));
        if (av_channel_layout_copy(&silence->ch_layout, &like.ch_layout) < 0 ||
            av_frame_get_buffer(silence.get(), 0) < 0)
            throw std::bad_alloc();
        av_samples_set_silence(silence->extended_data, 0, silence->nb_samples, like.ch_layout.nb_channels,
                               static_cast<AVSampleFormat>(like.format));
        while (count > 0) {
            const int now = static_cast<int>(std::min<std::int64_t>(count, silence->nb_samples));
            if (const int put = resample(const_cast<const std::uint8_t**>(silence->extended_data), now); put < 0)
                return put;
            if (const int coded = encode(false, emit); coded < 0) return coded;
            count -= now;
            heard += now;
        }
        return 0;
    }

    /// Puts a decoded frame at its time.
    int place(const AVFrame& frame, const Emit& emit) {
        if (!resampler_fits(frame)) {
            if (const int flushed = flush_resampler(); flushed < 0) return flushed;
            if (resampler) heard = av_rescale(heard, frame.sample_rate, rate);
            if (!start_resampler(frame)) return AVERROR(EINVAL);
            av_frame_unref(input.get());
            if (av_frame_ref(input.get(), &frame) < 0) throw std::bad_alloc();
        }
        const std::int64_t time = frame.best_effort_timestamp;
        const std::int64_t start =
            time == AV_NOPTS_VALUE
                ? heard
                : std::clamp(av_rescale_q(av_sat_sub64(time, origin), source_base, AVRational{1, rate}), -kFar, kFar);
        const auto slip = static_cast<std::int64_t>(kLargestSlip * rate), gap = std::int64_t{kLongestGap} * rate;
        int skip = 0;
        if (!placed) {
            skip = static_cast<int>(std::clamp<std::int64_t>(-start, 0, frame.nb_samples));
            if (skip == frame.nb_samples) return 0;
            placed = true;
            heard = start + skip;
            next_pts = av_rescale(heard, encoder->sample_rate, rate);
        } else if (start > heard + slip && start - heard < gap) {
            if (const int filled = fill(frame, start - heard, emit); filled < 0) return filled;
        } else if (start < heard - slip && heard - start < gap) {
            skip = static_cast<int>(std::min<std::int64_t>(heard - start, frame.nb_samples));
        }
        const int count = frame.nb_samples - skip;
        if (count == 0) return 0;
        const auto format = static_cast<AVSampleFormat>(frame.format);
        const bool planar = av_sample_fmt_is_planar(format);
        const int planes = planar ? frame.ch_layout.nb_channels : 1;
        const int step = av_get_bytes_per_sample(format) * (planar ? 1 : frame.ch_layout.nb_channels);
        std::vector<const std::uint8_t*> data;
        for (int i = 0; i < planes; ++i) data.push_back(frame.extended_data[i] + std::ptrdiff_t{skip} * step);
        heard += count;
        return resample(data.data(), count);
    }

    int send(const AVFrame* frame, const Emit& emit) {
        if (const int sent = avcodec_send_frame(encoder.get(), frame); sent < 0) return sent;
        while (true) {
            const int received = avcodec_receive_packet(encoder.get(), packet.get());
            if (received == AVERROR(EAGAIN) || received == AVERROR_EOF) return 0;
            if (received < 0) return received;
            packet->pts += lead;
            packet->dts += lead;
            if (const int written = emit(*packet); written < 0) return written;
        }
    }

    /// Codes the whole frames that the fifo holds. last: code the rest too.
    int encode(bool last, const Emit& emit) {
        const int whole = encoder->frame_size > 0 ? encoder->frame_size : kFreeFrameSize;
        while (av_audio_fifo_size(fifo.get()) >= (last ? 1 : whole)) {
            const Frame frame = make_frame();
            frame->nb_samples = std::min(whole, av_audio_fifo_size(fifo.get()));
            frame->format = encoder->sample_fmt;
            frame->sample_rate = encoder->sample_rate;
            if (av_channel_layout_copy(&frame->ch_layout, &encoder->ch_layout) < 0 ||
                av_frame_get_buffer(frame.get(), 0) < 0)
                throw std::bad_alloc();
            av_audio_fifo_read(fifo.get(), reinterpret_cast<void**>(frame->extended_data), frame->nb_samples);
            frame->pts = next_pts;
            next_pts += frame->nb_samples;
            if (const int sent = send(frame.get(), emit); sent < 0) return sent;
        }
        return 0;
    }

    /// Decodes a packet and codes the result. Null: the end.
    int decode(const AVPacket* source, const Emit& emit) {
        avcodec_send_packet(decoder.get(), source);  // a damaged packet leaves a gap
        while (avcodec_receive_frame(decoder.get(), decoded.get()) >= 0) {
            if (const int put = place(*decoded, emit); put < 0) return put;
            if (const int coded = encode(false, emit); coded < 0) return coded;
        }
        return 0;
    }
};

std::unique_ptr<AudioTranscoder> AudioTranscoder::open(const AVStream& from, const AVOutputFormat& container,
                                                       std::string& why) {
    auto state = std::make_unique<State>();
    state->source_base = from.time_base;
    state->decoder = open_decoder(from);
    if (!state->decoder) {
        why = fmt::format("{} files cannot hold it and libav cannot decode it", container.name);
        return nullptr;
    }
    for (const AVCodecID codec : wanted_codecs(container)) {
        const AVCodec* encoder = find_encoder(codec);
        if (encoder) state->encoder = open_encoder(*encoder, *state->decoder, container);
        if (state->encoder) break;
    }
    if (!state->encoder) {
        why = fmt::format("{} files hold no audio that libav can encode", container.name);
        return nullptr;
    }
    // Matroska's times count from the start of the encoder's delay, which its files state separately.
    const std::string_view name = container.name;
    if (name == "webm" || name == "matroska") state->lead = state->encoder->initial_padding;
    state->fifo.reset(av_audio_fifo_alloc(state->encoder->sample_fmt, state->encoder->ch_layout.nb_channels, 1));
    if (!state->fifo) throw std::bad_alloc();
    return std::unique_ptr<AudioTranscoder>(new AudioTranscoder(std::move(state)));
}

AudioTranscoder::AudioTranscoder(std::unique_ptr<State> state) : state_(std::move(state)) {}
AudioTranscoder::~AudioTranscoder() = default;

const AVCodecContext& AudioTranscoder::encoder() const {
    return *state_->encoder;
}

int AudioTranscoder::code(const AVPacket& packet, std::int64_t origin, const Emit& emit) {
    state_->origin = origin;
    return state_->decode(&packet, emit);
}

int AudioTranscoder::finish(const Emit& emit) {
    if (const int coded = state_->decode(nullptr, emit); coded < 0) return coded;
    if (const int flushed = state_->flush_resampler(); flushed < 0) return flushed;
    if (const int coded = state_->encode(true, emit); coded < 0) return coded;
    return state_->send(nullptr, emit);
}

}  // namespace eikonal::libav
