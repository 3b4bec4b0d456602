/// Codes an audio stream again for a movie container that cannot hold it as it is. The new codec is Opus in .webm.
/// Elsewhere it is the container's own in libav (AAC in .mp4), or else the first of Opus, AAC and 16-bit PCM that the
/// container holds. movie_copy.cpp uses it, and copies all other streams.
///
/// Bit rate: kOpusBitRate or kOtherBitRate for each channel. The channel layout is kept where the encoder has it, else
/// the sound is mixed to stereo. The sample rate is kept likewise, else the next higher one is taken (Opus: 48 kHz
/// for 44.1 kHz).
///
/// Time: a sample keeps its place to one sample of the new rate. Padding that the source marks is not coded. The
/// encoder's own delay goes into the container as such (pre-skip, edit list). So the number of audible samples stays
/// the same. A gap longer than kLargestSlip, as lost packets leave it, becomes silence. Beyond kLongestGap the time
/// stamps count as damaged, and the sound goes on. Sound that would begin too early by more than kLargestSlip is left
/// out. Damaged packets count as lost. The same packets give the same bytes: there is one thread, and no version
/// strings.
///
/// Failures: only std::bad_alloc is thrown. Calls return libav's error codes.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "warp/image/movie_libav.h"

namespace eikonal::libav {

inline constexpr int kOpusBitRate = 64000;    ///< a channel [bit/s]
inline constexpr int kOtherBitRate = 96000;   ///< a channel [bit/s]. AAC in stereo has 192 kb/s.
inline constexpr double kLargestSlip = 0.05;  ///< [s]
inline constexpr int kLongestGap = 600;       ///< [s]

/// Whether files of `container` can hold audio of `codec` so that players find it. libav's muxer tells. Some muxers
/// tell nothing (.ts, .ogv, .mxf) or claim too much (.mp4, .mov); for them a list of known codecs decides.
bool holds_audio(const AVOutputFormat& container, AVCodecID codec);

class AudioTranscoder {
  public:
    /// Takes a coded packet with times in time_base(). Returns 0 or libav's error code.
    using Emit = std::function<int(AVPacket&)>;

    /// A transcoder for `from`, whose packets a file of `container` cannot hold. Null if there can be none. `why` is
    /// then the reason, which completes "is dropped, ".
    static std::unique_ptr<AudioTranscoder> open(const AVStream& from, const AVOutputFormat& container,
                                                 std::string& why);
    ~AudioTranscoder();

    /// Parameters of the coded stream.
    const AVCodecContext& encoder() const;

    /// Codes a packet of the source. origin: time 0 of the new movie, in the source's time base. Sound before it is cut
    /// off.
    int code(const AVPacket& packet, std::int64_t origin, const Emit& emit);
    /// Codes the samples that are still held back. To be called at the end.
    int finish(const Emit& emit);

  private:
    struct State;
    explicit AudioTranscoder(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

}  // namespace eikonal::libav
