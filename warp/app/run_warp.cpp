/// `eikonal warp`: reads footage and writes it with shimmer.

#include <fmt/format.h>

#include <algorithm>

#include "noise/base/error.h"
#include "warp/app/commands.h"
#include "warp/app/explain.h"
#include "warp/app/footage.h"
#include "warp/app/map_files.h"
#include "warp/app/outputs.h"
#include "warp/app/pipeline.h"
#include "warp/app/report.h"
#include "warp/app/shot_options.h"
#include "warp/image/movie_reader.h"
#include "warp/image/movie_writer.h"
#include "warp/program/option_names.h"
#include "warp/program/thread_limit.h"
#include "warp/shimmer/warp_plate.h"

namespace eikonal {
namespace {

/// A plate in the pipeline.
struct PlateItem : FrameItem {
    Plate plate;                        ///< of pictures: empty until work() reads it
    std::optional<MovieFrame> encoded;  ///< used if the output is a movie
};

/// Memory per pixel of a frame [bytes]: linear colour of input, output and one instant; map; depth, matte and STMap.
/// The pixels as read come on top.
constexpr double kPixelBytes = 3 * 16 + 8 + 8 + 12;
constexpr double kChannelBytes = 2 * 4;

/// The frames to warp: the user's list `wanted`, or all that exist. `still`: the frame number of a still if none is
/// wanted.
std::vector<int> choose_frames(const WarpOptions& options, const Footage& footage, const std::vector<int>& wanted,
                               int still, bool& hole) {
    std::vector<int> frames = options.run.frames ? wanted : footage.frames;
    if (footage.kind == FootageKind::Still) return options.run.frames ? frames : std::vector<int>{still};
    if (footage.kind == FootageKind::Movie) {
        std::sort(frames.begin(), frames.end());
        const auto last = static_cast<int>(footage.frames.size());
        if (options.run.frames && (frames.front() < 1 || (last > 0 && frames.back() > last)))
            throw UserError(fmt::format("--frames {}: the frames of '{}' are 1 to {}", *options.run.frames,
                                        options.input.string(), last > 0 ? fmt::to_string(last) : "its last"));
        return frames;
    }
    std::vector<int> missing;
    if (options.run.frames) {
        std::error_code ignored;
        for (const int frame : frames)
            if (!std::filesystem::exists(footage.files.at(frame), ignored)) missing.push_back(frame);
    } else {
        missing = missing_frames(frames);
    }
    if (missing.empty()) return frames;
    hole = true;
    const std::string what = fmt::format("'{}' lacks frame{} {}", options.input.string(),
                                         missing.size() == 1 ? "" : "s", frame_list(missing));
    if (!options.run.skip_bad_frames)
        throw FrameError(what + "; --skip-bad-frames goes on without, --frames names those to make");
    fmt::print(stderr, "eikonal: warning: {}\n", what);
    std::erase_if(frames, [&](int f) { return std::find(missing.begin(), missing.end(), f) != missing.end(); });
    return frames;
}

/// The frame number of a still if --frames does not state it. It is the number in the file's name where sequences have
/// it, else the scene's first frame. `notice`: what to report about that, and about a number that may be meant.
int frame_of_still(const WarpOptions& options, int first_frame, std::string& notice) {
    if (options.run.frames || footage_kind(options.input) != FootageKind::Still) return first_frame;
    const auto named = number_in_name(options.input);
    if (!named || named->number == first_frame) return first_frame;
    const std::string file = options.input.string();
    notice = named->after_dot
                 ? fmt::format("'{}' gets the air of frame {}, as its name says; --frames names another", file,
                               named->number)
                 : fmt::format("'{}' gets the air of frame {}, as a still; --frames {} if it is that of a sequence",
                               file, first_frame, named->number);
    return named->after_dot ? named->number : first_frame;
}

class WarpRun {
  public:
    WarpRun(const WarpOptions& options, const Footage& footage, const FootageShot& shot, const Outputs& outputs,
            std::vector<int> frames, std::stop_token stop)
        : options_(options),
          footage_(footage),
          shot_(shot),
          outputs_(outputs),
          frames_(std::move(frames)),
          offsets_(shutter_offsets(options.shutter, options.samples)),
          stop_(std::move(stop)),
          output_(*outputs.find("-o")) {
        if (footage.kind == FootageKind::Movie) {
            reader_.emplace(options.input);
        } else if (footage.kind == FootageKind::Still) {
            try {
                still_ = read_picture(options.input);
            } catch (const FrameError& error) {
                throw FrameError(fmt::format("frame {}: {}", frames_.front(), error.what()));
            }
        }
        if (output_.single) open_movie();
    }

    std::unique_ptr<FrameItem> take() {
        // A movie whose container states no length is read to its end.
        const bool open_ended = reader_ && frames_.empty();
        if (!open_ended && next_ == frames_.size()) return nullptr;
        auto item = std::make_unique<PlateItem>();
        if (reader_) {
            failing_ = {reader_->next_number()};
            if (!open_ended) {
                const int wanted = frames_[next_++];
                while (reader_->next_number() < wanted && reader_->skip()) {
                }
                failing_ = {wanted};
            }
            MovieFrame frame;
            bool there = false;
            try {
                there = reader_->next(frame);
                // If the number of frames is an estimate, no frame is known to be missing.
                if (!there && (open_ended || (!options_.run.frames && !reader_->count_is_exact()))) return nullptr;
                if (!there) throw FrameError(fmt::format("'{}' ends earlier", options_.input.string()));
            } catch (const FrameError&) {
                // The frames that a too short movie lacks are reported at once.
                for (; reader_->at_end() && next_ < frames_.size(); ++next_) failing_.push_back(frames_[next_]);
                throw;
            }
            item->record.frame = frame.number;
            item->plate = std::move(frame);
        } else {
            item->record.frame = frames_[next_++];
        }
        return item;
    }
    std::vector<int> failing() const { return failing_; }

    void work(FrameItem& base) {
        auto& item = static_cast<PlateItem&>(base);
        const int frame = item.record.frame;
        const std::filesystem::path file = footage_.files.at(frame);
        if (footage_.kind == FootageKind::Still) item.plate = still_;
        if (footage_.kind == FootageKind::Sequence) item.plate = read_picture(file);
        const PixelWindow display = plate_display(item.plate);
        if (display.width != footage_.display.width || display.height != footage_.display.height)
            throw FrameError(fmt::format(
                "'{}' is {} x {}, but the shot is {} x {}; all frames of a shot must have one size", file.string(),
                display.width, display.height, footage_.display.width, footage_.display.height));
        const auto* picture = std::get_if<Picture>(&item.plate);
        const FrameInput input{picture, picture != nullptr ? file : options_.input, {}};
        const Shot::Maps made = shot_.maps(frame, offsets_, input, plate_window(item.plate), item.record.remarks);
        item.record.stated = made.error;
        const std::vector<DisplacementMap>& maps = made.of_instants;
        const DisplacementMap& middle = maps[maps.size() / 2];
        if (options_.run.report) {
            const MapStatistics size = statistics(middle);
            item.record.rms = size.rms;
            item.record.largest = size.largest;
        }
        if (const NamedFiles* stmap = outputs_.find("--stmap")) write_stmap(stmap->at(frame), middle, display);
        if (const NamedFiles* displacement = outputs_.find("--displacement"))
            write_displacement(displacement->at(frame), middle, display);
        if (const std::size_t strange =
                warp_plate(item.plate, maps, {options_.filter, options_.edge, options_.dispersion, stop_}))
            item.record.remarks.push_back(
                {"plate_finite",
                 fmt::format("'{}': {} colour values are NaN or infinite; where the air moves them, NaN "
                             "counts as 0 and infinity as 65504",
                             file.string(), strange)});
        if (output_.single) {
            if (picture == nullptr)
                item.encoded = std::move(std::get<MovieFrame>(item.plate));
            else
                item.encoded = frame_from_linear(main_colour(item.plate), *movie_format_, main_is_grey(*picture));
            item.plate = Picture{};
            return;
        }
        write_still(item.plate, output_.at(frame));
    }

    void finish(FrameItem& base) {
        if (writer_) writer_->write(*static_cast<PlateItem&>(base).encoded);
    }

    /// Closes the movie, and gives it its name if all frames were written.
    void close() {
        if (writer_) writer_->finish();
    }

  private:
    static bool main_is_grey(const Picture& picture) {
        for (const ChannelGroup& group : main_part(picture).groups)
            if (group.count > 0) return group.count == 1;
        return false;
    }

    void write_still(Plate& plate, const std::filesystem::path& file) const {
        if (auto* picture = std::get_if<Picture>(&plate))
            write_picture(file, picture_for_format(std::move(*picture), file));
        else
            write_picture(file,
                          picture_from_linear(main_colour(plate), file, footage_.has_alpha, footage_.source_bits));
    }

    void open_movie() {
        MovieSettings settings;
        settings.codec = options_.codec;
        settings.quality = options_.quality;
        settings.warn = [](const std::string& text) {
            fmt::print(stderr, "eikonal: warning: {}\n", with_options(text));
        };
        const std::filesystem::path& file = output_.files.text();
        if (reader_) {
            if (options_.run.frames) settings.frames = frames_;
            writer_.emplace(file, *reader_, settings);
            return;
        }
        movie_format_ = sequence_format(file, footage_.display.width, footage_.display.height, footage_.source_bits,
                                        footage_.pixel_aspect, options_.codec);
        Rational fps{static_cast<std::int64_t>(shot_.shot().fps() * 1000 + 0.5), 1000};
        if (footage_.fps && !shot_.shot().scene().time.fps) fps = *footage_.fps;
        writer_.emplace(file, *movie_format_, fps, settings);
    }

    const WarpOptions& options_;
    const Footage& footage_;
    const FootageShot& shot_;
    const Outputs& outputs_;
    std::vector<int> frames_;
    std::vector<double> offsets_;
    std::stop_token stop_;
    const NamedFiles& output_;
    std::optional<MovieReader> reader_;
    std::optional<MovieWriter> writer_;
    std::optional<MovieFormat> movie_format_;
    Picture still_;
    std::size_t next_ = 0;
    std::vector<int> failing_{0};
};

/// Finds wrong options for depth and matte before the first frame is begun.
void try_companions(const Footage& footage, const FootageShot& shot, int frame) {
    const std::filesystem::path file = footage.files.at(frame);
    if (footage.kind == FootageKind::Movie) return shot.try_companions(frame, {nullptr, file, {}}, footage.display);
    try {
        const Plate plate = shot.depth().inside_picture() ? read_picture(file) : read_picture_header(file);
        shot.try_companions(frame, {&std::get<Picture>(plate), file, {}}, plate_window(plate));
    } catch (const FrameError&) {
        // An error of the frame itself is reported when its turn comes.
    }
}

/// Approximate memory of a frame in the pipeline [bytes].
double bytes_of_frame(const WarpOptions& options, const Footage& footage, const FootageShot& shot) {
    return shot.shot().frame_bytes(kPixelBytes + kChannelBytes * footage.channels + 8.0 * options.samples);
}

RunResult warp_frames(const WarpOptions& options, const Footage& footage, const FootageShot& shot,
                      const Outputs& outputs, const std::vector<int>& frames, int threads,
                      const std::stop_token& stop) {
    try_companions(footage, shot, frames.empty() ? 1 : frames.front());
    WarpRun warp(options, footage, shot, outputs, frames, stop);
    const Stages stages{[&] { return warp.take(); }, [&] { return warp.failing(); },
                        [&](FrameItem& item) { warp.work(item); }, [&](FrameItem& item) { warp.finish(item); },
                        footage_kind(options.output) == FootageKind::Movie};
    RunResult result =
        run_pipeline(stages, options.run, frames.size(), threads, bytes_of_frame(options, footage, shot), stop);
    if (!result.interrupted && (options.run.skip_bad_frames || !result.failed())) warp.close();
    return result;
}

/// The number of frames that an existing movie should have. If the container of the source states none, the source is
/// read through to count them.
AskedFrames asked_of_movie(const WarpOptions& options, const Footage& footage, const std::vector<int>& frames) {
    const bool counted =
        footage.kind != FootageKind::Movie || options.run.frames || (footage.count_is_exact && !frames.empty());
    const auto found = counted || !std::filesystem::exists(options.output) ? std::nullopt : count_frames(options.input);
    return {found ? static_cast<std::size_t>(*found) : frames.size(), counted || found, options.run.skip_bad_frames};
}

Outputs warp_outputs(const WarpOptions& options) {
    Outputs outputs;
    outputs.add("-o", options.output, OutputKind::Pictures);
    if (options.stmap) outputs.add("--stmap", *options.stmap, OutputKind::Maps);
    if (options.displacement) outputs.add("--displacement", *options.displacement, OutputKind::Maps);
    if (options.run.report) outputs.add("--report", *options.run.report, OutputKind::Report);
    if (!outputs.find("-o")->single && (!options.codec.empty() || options.quality))
        throw UserError(fmt::format("{}: is for movies, but '{}' is none; leave it out or name a .mov",
                                    options.codec.empty() ? "--quality" : "--codec", options.output.string()));
    return outputs;
}

/// The footage, and its frames to warp.
struct Take {
    Footage footage;
    std::vector<int> frames;
    bool hole = false;  ///< whether frames are missing between them
};

/// Looks for the footage, and reports on stderr what is unusual about it.
Take find_take(const WarpOptions& options, int first_frame) {
    const std::vector<int> wanted = options.run.frames ? parse_frames(*options.run.frames) : std::vector<int>{};
    std::string notice;
    const int still = frame_of_still(options, first_frame, notice);
    Take take;
    take.footage = find_footage(options.input, wanted, still);
    if (!notice.empty()) fmt::print(stderr, "eikonal: {}\n", notice);
    for (const std::string& note : take.footage.notes) fmt::print(stderr, "eikonal: warning: {}\n", note);
    take.frames = choose_frames(options, take.footage, wanted, still, take.hole);
    return take;
}

FootageShotSettings warp_settings(const WarpOptions& options, const Footage& footage, const std::stop_token& stop) {
    FootageShotSettings settings = shot_settings(options.shot, options.run, stop);
    settings.view.display = footage.display;
    settings.view.pixel_aspect = footage.pixel_aspect;
    if (footage.fps) settings.view.fps = footage.fps->value();
    settings.view.overscan = [&] { return pixels_of(footage); };
    return settings;
}

ExplainedRun explained(const WarpOptions& options, const FootageShot& shot, const Take& take, int first,
                       std::size_t kept, int threads) {
    const Footage& footage = take.footage;
    const bool pictures = footage.kind != FootageKind::Movie;
    return {footage.display,
            take.frames,
            first,
            pictures ? footage.files.at(first) : std::filesystem::path(),
            kept,
            threads,
            bytes_of_frame(options, footage, shot),
            options.filter,
            options.samples};
}

}  // namespace

int run(const WarpOptions& options, const std::stop_token& stop) {
    const ThreadLimit limit(options.run.threads);

    Scene scene = load_scene(options.shot.scene);
    const Outputs outputs = warp_outputs(options);
    const bool to_movie = outputs.find("-o")->single;
    Take take = find_take(options, scene.time.first_frame);
    const Footage& footage = take.footage;
    std::vector<int>& frames = take.frames;
    const FootageShot shot(std::move(scene), warp_settings(options, footage, stop));
    std::vector<NamedFiles> inputs = companions(shot);
    inputs.push_back({"the input", footage.files, footage.kind == FootageKind::Movie});
    outputs.check(frames, inputs);
    RunSummary summary{announce(shot, frames, options.run.verbose), 0, 0,
                       to_movie ? "the movie was not written" : "the same command makes the rest"};

    const int first = frames.empty() ? shot.shot().scene().time.first_frame : frames.front();
    if (!options.run.overwrite) {
        if (!to_movie)
            summary.kept = outputs.keep_finished(frames, footage.display, stop);
        else if (!options.run.explain && outputs.keep_movie(footage.display, asked_of_movie(options, footage, frames)))
            return take.hole ? 1 : 0;
    }
    if (options.run.explain) {
        explain(shot, explained(options, shot, take, first, summary.kept, limit.threads()));
        return 0;
    }
    if (!options.run.skip_bad_frames)
        if (const auto missing = shot.missing_companion(frames)) throw FrameError(*missing);
    RunResult result;
    if (summary.kept == 0 || !frames.empty())
        result = warp_frames(options, footage, shot, outputs, frames, limit.threads(), stop);
    summary.total = frames.size();
    const int status = conclude(shot, options.run, summary, result);
    return take.hole ? 1 : status;
}

}  // namespace eikonal
