/// Codes an audio stream again for a movie container that cannot hold it as it is: Opus in .webm, elsewhere what libav
/// takes as the container's own (AAC in .mp4), or the first of Opus, AAC and 16-bit PCM that it holds. Used by
/// movie_copy.cpp; streams that the container holds are copied instead.
///
/// Bit rate: kOpusBitRate or kOtherBitRate a channel. The channel layout is kept where the encoder has it, else mixed
/// to stereo; the sample rate likewise, else the next higher one (Opus: 48 kHz for 44.1 kHz).
///
/// Time: a sample keeps its place to one sample of the new rate. What the source marks as padding is not coded, the
/// encoder's own delay goes into the container as such (pre-skip, edit list), so that as many samples are heard as
/// before. Gaps longer than kLargestSlip, as lost packets leave them, become silence (beyond kLongestGap the
/// time stamps are taken for damaged, and the sound goes on); what would be heard before its
/// turn by more than that is left out. Damaged packets count as lost.
/// The same packets give the same bytes: one thread, no version strings.
///
/// Failures: none is thrown but std::bad_alloc; calls return libav's error codes.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "warp/image/movie_libav.h"

namespace eikonal::libav {

inline constexpr int kOpusBitRate = 64000;    ///< a channel [bit/s]
inline constexpr int kOtherBitRate = 96000;   ///< a channel [bit/s]: AAC of 192 kb/s in stereo
inline constexpr double kLargestSlip = 0.05;  ///< [s]
inline constexpr int kLongestGap = 600;       ///< [s]

/// True if files of `container` can hold audio of `codec`, and players find it there: what libav's muxer says, and for
/// those that say nothing (.ts, .ogv, .mxf) or too much (.mp4, .mov) what they are known to hold.
bool holds_audio(const AVOutputFormat& container, AVCodecID codec);

class AudioTranscoder {
  public:
    /// Takes a coded packet, in time_base(); returns 0 or libav's error code.
    using Emit = std::function<int(AVPacket&)>;

    /// For `from`, whose packets a file of `container` cannot hold. Null if that is impossible; `why` then says so, to
    /// follow "is dropped, ".
    static std::unique_ptr<AudioTranscoder> open(const AVStream& from, const AVOutputFormat& container,
                                                 std::string& why);
    ~AudioTranscoder();

    /// Parameters of the coded stream.
    const AVCodecContext& encoder() const;

    /// Codes a packet of the source. `origin` [source's time base] is time 0 of the new movie; sound before it is cut
    /// off.
    int code(const AVPacket& packet, std::int64_t origin, const Emit& emit);
    /// Codes what is still held back: the end.
    int finish(const Emit& emit);

  private:
    struct State;
    explicit AudioTranscoder(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace eikonal::libav
