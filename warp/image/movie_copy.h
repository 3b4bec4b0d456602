/// Carries what is not picture from a source movie into a new one: audio, subtitle, data and attachment streams packet
/// by packet, chapters, metadata, and the side data of the video stream. Audio that the new container cannot hold is
/// coded again (movie_audio.h). Used by movie_writer.cpp.
///
/// The source is opened anew and read in step with the new movie's time, so that nothing piles up in memory.
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

    /// Metadata, rotation and such of the video stream.
    void describe_video(AVStream& to) const;
    /// Metadata of the file.
    void describe_file(AVFormatContext& to) const;
    /// Chapters; for whole movies only. `origin` is subtracted from their times (AV_TIME_BASE units).
    void copy_chapters(AVFormatContext& to, std::int64_t origin) const;
    /// Adds a stream for each that `to` can hold, as it is or coded again; `warn` is told of the latter and of those
    /// that are dropped.
    void add_streams(AVFormatContext& to, const Warn& warn);
    /// Tells `warn` that no stream is copied, if there are any.
    void drop_streams(const Warn& warn, const std::string& why) const;

    /// Time zero of the new movie in the source's time, and whether packets before it are left out.
    void start_at(std::int64_t time, AVRational time_base, bool trim);
    /// Copies packets up to `time` (source's time; nothing: all that are left) into `to`; returns libav's error code,
    /// or 0.
    int copy_until(AVFormatContext& to, std::optional<std::int64_t> time, AVRational time_base);
    /// Ends the streams that are coded again; returns libav's error code, or 0.
    int finish(AVFormatContext& to);

  private:
    struct Target {
        AVStream* stream = nullptr;
        std::unique_ptr<AudioTranscoder> coder;  ///< null: copied
        std::int64_t last_dts = AV_NOPTS_VALUE;
    };
    bool wanted() const;
    int take_packet(AVFormatContext& to);
    /// Writes a packet whose time stamps are in `time_base`, from time 0 of the new movie.
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
