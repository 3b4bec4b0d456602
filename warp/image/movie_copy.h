/// Carries everything but the picture from a source movie into a new one: packets of audio, subtitle, data and
/// attachment streams, chapters, metadata, and the side data of the video stream. Audio that the new container cannot
/// hold is coded again (movie_audio.h). movie_writer.cpp uses it.
///
/// The source is opened a second time and read in step with the new movie's time, so that memory does not grow.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "warp/image/movie_audio.h"
#include "warp/image/movie_libav.h"

namespace eikonal::libav {

class StreamCopier {
  public:
    using Warn = std::function<void(const std::string&)>;

    explicit StreamCopier(const std::filesystem::path& source);

    const AVFormatContext& input() const { return *input_; }
    const AVStream& video() const { return *video_; }

    /// Copies metadata, rotation and other side data of the video stream.
    void describe_video(AVStream& to) const;
    /// Copies the metadata of the file.
    void describe_file(AVFormatContext& to) const;
    /// Copies the chapters, for whole movies only. origin: subtracted from their times [AV_TIME_BASE units].
    void copy_chapters(AVFormatContext& to, std::int64_t origin) const;
    /// Adds every stream that `to` can hold as it is or coded again. `warn` is told of streams that are coded again or
    /// dropped.
    void add_streams(AVFormatContext& to, const Warn& warn);
    /// Tells `warn` that no stream is copied, if there are streams to copy.
    void drop_streams(const Warn& warn, const std::string& why) const;

    /// Sets time 0 of the new movie, in the source's time. trim: leave out earlier packets.
    void start_at(std::int64_t time, AVRational time_base, bool trim);
    /// Copies packets up to `time`, in the source's time, into `to`. Without a time it copies all that are left.
    /// Returns libav's error code, or 0.
    int copy_until(AVFormatContext& to, std::optional<std::int64_t> time, AVRational time_base);
    /// Ends the streams that are coded again. Returns libav's error code, or 0.
    int finish(AVFormatContext& to);

  private:
    struct Target {
        AVStream* stream = nullptr;
        std::unique_ptr<AudioTranscoder> coder;  ///< null: copied
        std::int64_t last_dts = AV_NOPTS_VALUE;
    };
    bool wanted() const;
    int take_packet(AVFormatContext& to);
    /// Writes a packet. Its time stamps are in `time_base` and count from time 0 of the new movie.
    static int write_packet(AVFormatContext& to, Target& target, AVPacket& packet, AVRational time_base);
    static AudioTranscoder::Emit writer(AVFormatContext& to, Target& target);

    Input input_;
    const AVStream* video_ = nullptr;
    std::vector<Target> targets_;  ///< by the source's stream index
    Packet packet_ = make_packet();
    bool pending_ = false, ended_ = false, trim_ = false;
    std::int64_t origin_ = 0;
    AVRational origin_base_{1, AV_TIME_BASE};
};

}  // namespace eikonal::libav
