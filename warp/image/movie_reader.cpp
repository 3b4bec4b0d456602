#include "warp/image/movie_reader.h"

extern "C" {
#include <libavutil/display.h>
#include <libavutil/parseutils.h>
}

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <deque>
#include <set>
#include <utility>

#include "noise/base/error.h"
#include "warp/image/movie_libav.h"

namespace eikonal {

namespace {

constexpr int kMaxDecodeThreads = 16;

Rational rational(AVRational value) {
    return {value.num, value.den == 0 ? 1 : value.den};
}

/// "01:02:03.456" of Matroska's DURATION tag in seconds, or 0.
double seconds_of_tag(const AVDictionary* metadata) {
    const AVDictionaryEntry* entry = av_dict_get(metadata, "DURATION", nullptr, 0);
    std::int64_t microseconds = 0;
    if (!entry || av_parse_time(&microseconds, entry->value, 1) < 0) return 0;
    return static_cast<double>(microseconds) * 1e-6;
}

int rotation_of(const AVStream& stream) {
    const auto* matrix =
        reinterpret_cast<const std::int32_t*>(av_stream_get_side_data(&stream, AV_PKT_DATA_DISPLAYMATRIX, nullptr));
    if (!matrix) return 0;
    const double anticlockwise = av_display_rotation_get(matrix);
    if (!(std::abs(anticlockwise) <= 360)) return 0;  // NaN: a singular matrix
    const int quarters = static_cast<int>(std::lround(-anticlockwise / 90));
    return ((quarters % 4 + 4) % 4) * 90;
}

}  // namespace

struct MovieReader::State {
    std::filesystem::path path;
    libav::Input input;
    libav::Codec decoder;
    AVStream* stream = nullptr;
    libav::Frame picture = libav::make_frame();
    libav::Packet packet = libav::make_packet(), ahead = libav::make_packet();
    MovieFormat format;
    std::atomic<bool> complained = false;  ///< the decoder reported an error
    bool pending = false;                  ///< `picture` is decoded and not yet handed out
    bool looked_ahead = false;             ///< `ahead` holds the packet after the last one sent
    bool finished = false;                 ///< file and decoder are at their end
    bool interlaced = false;
    int number = 0;                ///< number of the last decoded frame
    std::int64_t next_pts = 0;     ///< the time of a frame without a time stamp
    std::int64_t end_pts = 0;      ///< largest end of a frame so far
    std::deque<FrameError> early;  ///< errors of damaged frames before the first whole one, not yet reported
    std::set<std::pair<std::int64_t, std::int64_t>> incomplete;  ///< position and pts of packets that lack data
    std::string read_error;                                      ///< why reading stopped before the file's end

    explicit State(std::filesystem::path file) : path(std::move(file)) { open(); }

    FrameError error(int frame, const std::string& what) const {
        return FrameError(fmt::format("{}: frame {}: {}", path.string(), frame, what));
    }

    void open() {
        input = libav::open_input(path);
        stream = libav::video_stream(input.get());
        if (!stream)
            throw FrameError(fmt::format("{}: has no video stream; name a movie with pictures", path.string()));
        for (unsigned i = 0; i < input->nb_streams; ++i)
            if (input->streams[i] != stream) input->streams[i]->discard = AVDISCARD_ALL;

        const AVCodec* codec = avcodec_find_decoder(stream->codecpar->codec_id);
        if (!codec)
            throw FrameError(fmt::format("{}: no decoder for its codec {}; convert it first", path.string(),
                                         avcodec_get_name(stream->codecpar->codec_id)));
        decoder.reset(avcodec_alloc_context3(codec));
        if (!decoder || avcodec_parameters_to_context(decoder.get(), stream->codecpar) < 0) throw std::bad_alloc();
        decoder->pkt_timebase = stream->time_base;
        decoder->err_recognition = AV_EF_CRCCHECK;
        if (codec->id == AV_CODEC_ID_FFV1) {  // it reports damage by a message only, while it decodes the frame
            decoder->thread_type = FF_THREAD_SLICE;
            libav::watch_errors(*decoder, complained);
        }
        const auto threads = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
        decoder->thread_count = static_cast<int>(std::min<std::size_t>(threads, kMaxDecodeThreads));
        if (const int opened = avcodec_open2(decoder.get(), codec, nullptr); opened < 0)
            throw FrameError(
                fmt::format("{}: cannot decode {}: {}", path.string(), codec->name, libav::reason(opened)));

        find_first();
        format = format_of(*picture);
        interlaced = picture->interlaced_frame != 0;
    }

    /// Decodes the first whole frame. Keeps the errors of frames before it for next().
    void find_first() {
        while (!pending) {
            try {
                pending = decode();
            } catch (const FrameError& damage) {
                early.push_back(damage);
            }
            if (pending || !finished) continue;
            if (!early.empty()) throw early.front();
            throw FrameError(fmt::format("{}: holds no frame that can be decoded", path.string()));
        }
    }

    MovieFormat format_of(const AVFrame& frame) const {
        const auto pixel_format = static_cast<AVPixelFormat>(frame.format);
        MovieFormat result = libav::family_of(pixel_format);
        result.width = frame.width;
        result.height = frame.height;
        const std::string_view name = av_get_pix_fmt_name(pixel_format);
        result.range = name.starts_with("yuvj") || frame.color_range == AVCOL_RANGE_JPEG ? CodeRange::Full
                       : frame.color_range == AVCOL_RANGE_MPEG                           ? CodeRange::Limited
                                                                                         : CodeRange::Unspecified;
        result.primaries = frame.color_primaries;
        result.transfer = frame.color_trc;
        result.matrix = frame.colorspace;
        result.siting = static_cast<ChromaSiting>(frame.chroma_location);
        const AVRational aspect = av_guess_sample_aspect_ratio(input.get(), stream, const_cast<AVFrame*>(&frame));
        if (aspect.num > 0 && aspect.den > 0) result.pixel_aspect = av_q2d(aspect);
        return result;
    }

    /// Feeds packets until `picture` holds the next frame, and sets its time stamp. False at the end. FrameError.
    bool decode() {
        while (!finished) {
            const int received = avcodec_receive_frame(decoder.get(), picture.get());
            if (received == 0) {
                ++number;
                const bool whole = incomplete.erase({picture->pkt_pos, picture->pts}) == 0;
                stamp();
                return check_picture(whole);
            }
            if (received == AVERROR_EOF) {
                finished = true;
                check_length();
                return false;
            }
            if (received != AVERROR(EAGAIN)) damaged(received);
            feed();
        }
        return false;
    }

    void damaged(int code) {
        ++number;
        next_pts += nominal_duration();
        throw error(number, fmt::format("the stream is damaged: {}", libav::reason(code)));
    }

    /// Reads the stream's next packet. False if no more can be read.
    bool read(AVPacket& into) {
        while (true) {
            av_packet_unref(&into);
            const int code = av_read_frame(input.get(), &into);
            if (code == 0 && into.stream_index == stream->index) return true;
            if (code == 0 || code == AVERROR(EAGAIN)) continue;
            if (code != AVERROR_EOF) read_error = libav::reason(code);
            return false;
        }
    }

    /// Gives the decoder one more packet of the stream, or tells it that there is none. An incomplete packet is a
    /// damaged frame if others follow. Else it is the end of a movie that is cut off.
    void feed() {
        bool there = true;
        if (std::exchange(looked_ahead, false))
            av_packet_move_ref(packet.get(), ahead.get());
        else
            there = read(*packet);
        if (there && packet->flags & AV_PKT_FLAG_CORRUPT) {
            there = looked_ahead = read(*ahead);
            if (there)
                incomplete.emplace(packet->pos, packet->pts);
            else if (read_error.empty())
                read_error = "the last data are incomplete";
        }
        const int sent = avcodec_send_packet(decoder.get(), there ? packet.get() : nullptr);
        av_packet_unref(packet.get());
        if (sent < 0 && sent != AVERROR(EAGAIN) && sent != AVERROR_EOF) damaged(sent);
    }

    void stamp() {
        if (picture->best_effort_timestamp == AV_NOPTS_VALUE) picture->best_effort_timestamp = next_pts;
        picture->pts = picture->best_effort_timestamp;
        if (picture->pkt_duration <= 0) picture->pkt_duration = nominal_duration();
        next_pts = picture->pts + picture->pkt_duration;
        end_pts = std::max(end_pts, next_pts);
    }

    bool check_picture(bool whole) {
        constexpr int kConcealed =
            FF_DECODE_ERROR_INVALID_BITSTREAM | FF_DECODE_ERROR_CONCEALMENT_ACTIVE | FF_DECODE_ERROR_DECODE_SLICES;
        if (picture->decode_error_flags & kConcealed || picture->flags & AV_FRAME_FLAG_CORRUPT ||
            complained.exchange(false) || !whole)
            throw error(number, "its data are damaged; the decoder could only guess the picture");
        if (format.width == 0) return true;
        const MovieFormat now = format_of(*picture);
        if (now.width != format.width || now.height != format.height)
            throw error(number, fmt::format("the picture changes from {}x{} to {}x{}; split the movie there",
                                            format.width, format.height, now.width, now.height));
        if (now.depth != format.depth || now.rgb != format.rgb || now.gray != format.gray ||
            now.alpha != format.alpha || now.log2_chroma_w != format.log2_chroma_w ||
            now.log2_chroma_h != format.log2_chroma_h)
            throw error(number, fmt::format("the pixel format changes to {}; split the movie there",
                                            av_get_pix_fmt_name(static_cast<AVPixelFormat>(picture->format))));
        return true;
    }

    std::int64_t nominal_duration() const {
        const AVRational rate = frame_rate();
        if (rate.num <= 0) return 1;
        return std::max<std::int64_t>(1, av_rescale_q(1, av_inv_q(rate), stream->time_base));
    }

    AVRational frame_rate() const { return av_guess_frame_rate(input.get(), stream, nullptr); }

    /// The time at which the first frame is shown [s].
    double start() const {
        return stream->start_time == AV_NOPTS_VALUE
                   ? 0
                   : static_cast<double>(stream->start_time) * av_q2d(stream->time_base);
    }

    /// The video's length that the header states [s], or 0.
    double stated_length() const {
        // Matroska's tag is the time at which the last frame ends. Its clock may begin before the first frame.
        if (const double tagged = seconds_of_tag(stream->metadata); tagged > 0) return tagged - std::max(0.0, start());
        const bool stated = input->duration_estimation_method == AVFMT_DURATION_FROM_STREAM;
        if (stated && stream->duration > 0) return static_cast<double>(stream->duration) * av_q2d(stream->time_base);
        if (stated && input->nb_streams == 1 && input->duration > 0)
            return static_cast<double>(input->duration) / AV_TIME_BASE;
        return 0;
    }

    /// A movie that is cut off between two packets just ends. Only the length in its header reveals it.
    void check_length() {
        const double unit = av_q2d(stream->time_base);
        const double length = static_cast<double>(end_pts) * unit - start();
        const double slack = 2.5 * static_cast<double>(nominal_duration()) * unit;
        const double stated = stated_length();
        if (read_error.empty() && !(stated > length + slack)) return;
        std::string what = fmt::format("the movie is cut off after frame {}", number);
        if (stated > length + slack) what += fmt::format(": {:.2f} s of {:.2f} s are there", length, stated);
        if (!read_error.empty()) what += ": " + read_error;
        ++number;
        throw error(number, what + "; copy it again or choose fewer frames");
    }
};

std::optional<std::int64_t> count_frames(const std::filesystem::path& path) {
    const libav::Input input = libav::open_input(path);
    const AVStream* video = libav::video_stream(input.get());
    if (video == nullptr) throw FrameError(fmt::format("{}: has no video stream", path.string()));
    for (unsigned i = 0; i < input->nb_streams; ++i)
        if (input->streams[i] != video) input->streams[i]->discard = AVDISCARD_ALL;
    const libav::Packet packet = libav::make_packet();
    std::int64_t frames = 0;
    int code = 0;
    while ((code = av_read_frame(input.get(), packet.get())) == 0) {
        const bool whole = (packet->flags & AV_PKT_FLAG_CORRUPT) == 0;
        const bool shown = packet->stream_index == video->index && (packet->flags & AV_PKT_FLAG_DISCARD) == 0;
        av_packet_unref(packet.get());
        if (!whole) code = AVERROR_INVALIDDATA;
        if (!whole) break;
        if (shown) ++frames;
    }
    if (code != AVERROR_EOF)
        throw FrameError(fmt::format("{}: is cut off after frame {}: {}", path.string(), frames, libav::reason(code)));
    if (video->codecpar->codec_id == AV_CODEC_ID_THEORA) return std::nullopt;
    return frames;
}

MovieReader::MovieReader(std::filesystem::path path) : state_(std::make_unique<State>(std::move(path))) {}
MovieReader::MovieReader(MovieReader&&) noexcept = default;
MovieReader& MovieReader::operator=(MovieReader&&) noexcept = default;
MovieReader::~MovieReader() = default;

const std::filesystem::path& MovieReader::path() const {
    return state_->path;
}
const MovieFormat& MovieReader::format() const {
    return state_->format;
}
Rational MovieReader::fps() const {
    return rational(state_->frame_rate());
}
Rational MovieReader::time_base() const {
    return rational(state_->stream->time_base);
}
int MovieReader::rotation() const {
    return rotation_of(*state_->stream);
}
bool MovieReader::interlaced() const {
    return state_->interlaced;
}
bool MovieReader::at_end() const {
    return state_->finished && !state_->pending && state_->early.empty();
}
int MovieReader::next_number() const {
    return state_->pending ? state_->number - static_cast<int>(state_->early.size()) : state_->number + 1;
}

std::optional<std::int64_t> MovieReader::frame_count() const {
    if (state_->stream->nb_frames > 0) return state_->stream->nb_frames;
    const double count = std::round(state_->stated_length() * fps().value());
    if (count >= 1) return static_cast<std::int64_t>(count);
    return std::nullopt;
}

bool MovieReader::count_is_exact() const {
    return state_->stream->nb_frames > 0;
}

bool MovieReader::next(MovieFrame& frame) {
    State& state = *state_;
    if (!state.early.empty()) {
        const FrameError damage = state.early.front();
        state.early.pop_front();
        throw damage;
    }
    if (!state.pending && !state.decode()) return false;
    state.pending = false;
    frame.format = state.format;
    frame.pts = state.picture->pts;
    frame.duration = state.picture->pkt_duration;
    frame.number = state.number;
    libav::read_planes(*state.picture, frame);
    return true;
}

bool MovieReader::skip() {
    State& state = *state_;
    if (!state.early.empty()) {
        state.early.pop_front();
        return true;
    }
    if (std::exchange(state.pending, false)) return true;
    try {
        return state.decode();
    } catch (const FrameError&) {
        return !state.finished;
    }
}

}  // namespace eikonal
