#include "warp/app/shot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "noise/base/error.h"
#include "warp/displace/stated_error.h"
#include "warp/image/interrupt.h"
#include "warp/image/plane.h"

namespace eikonal {

std::filesystem::path scene_file_of(const SceneOptions& options) {
    return options.scene ? *options.scene : find_preset(options.preset.value_or("gentle"));
}

Scene load_scene(const SceneOptions& options) {
    return read_scene(scene_file_of(options), options.settings, options.seed);
}

namespace {

/// What the displacement is to be multiplied by.
double gain_for(const Displacer& displacer, const StrengthOptions& strength, double far) {
    if (!strength.rms) return strength.gain;
    const double natural = displacer.expected_rms(far);
    if (natural == 0 && *strength.rms > 0)
        throw UserError(
            fmt::format("--rms {:g}: the scene moves nothing that could be scaled to it; give turbulence some strength "
                        "(cn2), and its lattice, if it has one, 4 samples or more in x, y and z, or bring blobs into "
                        "the view, before the plate",
                        *strength.rms));
    return natural > 0 ? strength.gain * *strength.rms / natural : 0;
}

/// A line on each lattice that has strength and no wave with a slope: with two samples a period all are at Nyquist.
std::vector<std::string> flat_lattices(const Scene& scene) {
    std::vector<std::string> lines;
    for (std::size_t i = 0; i < scene.media.size(); ++i) {
        const auto* spec = std::get_if<TurbulenceSpec>(&scene.media[i]);
        if (spec == nullptr || spec->form != TurbulenceForm::Lattice || !spec->lattice) continue;
        const double source = spec->spectrum == SpectrumKind::VonKarman ? spec->cn2 : spec->strength;
        const std::array<int, 4>& n = *spec->lattice;
        if (source * force_strength(scene.optics) != 0 && std::count(n.begin(), n.begin() + 3, 2) >= 2)
            lines.push_back(fmt::format(
                "medium.{}: moves nothing: of two samples a period, as in its lattice [{}], no wave has a slope that "
                "bends light; give it 4 or more in x, y and z",
                i, fmt::join(n, ", ")));
    }
    return lines;
}

/// One line on how the model was chosen.
std::string describe(const ModelChoice& choice, double tolerance) {
    if (choice.exact)
        return fmt::format(
            "auto: nothing to choose, no medium of this scene takes a model; off by {} at most in 95 of "
            "100 sampled pixels",
            shown_error(choice.p95));
    std::string others;
    for (const TriedModel& tried : choice.tried)
        if (tried.model != choice.model)
            others += fmt::format("{}{} {}", others.empty() ? "; " : ", ", name_of(tried.model),
                                  tried.refusal.empty() ? shown_error(tried.p95) : "does not apply");
    return fmt::format("auto: model {}, off by {} at most in 95 of 100 sampled pixels, {} the tolerance of {:g} px{}",
                       name_of(choice.model), shown_error(choice.p95), choice.within ? "within" : "beyond", tolerance,
                       others);
}

}  // namespace

Shot::Shot(Scene scene, const SceneOptions& scene_options, const DepthArguments& depth, const StrengthOptions& strength,
           const PixelWindow& display, double pixel_aspect, std::optional<double> fps,
           const std::function<PixelWindow()>& overscan, bool state_errors)
    : scene_(std::move(scene)),
      depth_(depth, scene_),
      strength_(strength),
      meeting_(depth.meeting.value_or(DepthMeeting::March)),
      display_(display),
      fps_(scene_.time.fps.value_or(fps.value_or(kDefaultFps))),
      tolerance_(strength.tolerance),
      state_errors_(state_errors || strength.tolerance || strength.model.automatic) {
    settings_.width = display.width;
    settings_.height = display.height;
    settings_.pixel_aspect = pixel_aspect;
    settings_.fps = fps_;
    settings_.fov = scene_options.fov;
    settings_.far = depth_.far();
    settings_.deepest = depth_.deepest();
    settings_.overscan = overscan;
    settings_.model = strength.model.model;
    settings_.sample_errors = state_errors_;
    settings_.cancelled = interrupted;
    // --rms makes the weakest visible
    settings_.negligible = strength.rms || strength.gain == 0 ? 0 : kNegligibleShift / std::abs(strength.gain);
    if (strength.model.automatic || (strength.tolerance && !strength.model.model)) {
        if (!tolerance_) tolerance_ = kDefaultTolerance;
        choice_ = choose_model(scene_, settings_, *tolerance_, shot_depth(), gain_of());
        displacer_ = std::move(choice_->displacer);
    } else {
        displacer_ = std::make_unique<Displacer>(scene_, settings_);
    }
    gain_ = gain_of()(*displacer_);
    if (strength.mask) {
        const FileChannel split = split_channel(*strength.mask);
        if (split.file.empty())
            throw UserError(fmt::format("--mask: '{}' names no file; give FILE or FILE:CHANNEL", *strength.mask));
        refuse_movie("--mask", split.file, "mask");
        mask_ = FilePattern::parse(split.file);
        mask_channel_ = split.channel;
    }
}

GainOf Shot::gain_of() const {
    return [this](const Displacer& displacer) { return gain_for(displacer, strength_, depth_.far()); };
}

std::optional<Model> Shot::sufficient_model(double p95) const {
    if (displacer_->models().empty()) return {};
    const Model model = choice_ ? choice_->model : strength_.model.model.value_or(Model::SecondOrder);
    return eikonal::sufficient_model(scene_, settings_, *tolerance_, shot_depth(), gain_of(), model, p95);
}

ShotDepth Shot::shot_depth() const {
    if (const auto distance = depth_.constant()) return {*distance, meeting_};
    if (!depth_.still()) return {{}, meeting_};
    const int frame = scene_.time.first_frame;
    const CameraPath path(scene_.camera, settings_.width, settings_.height, settings_.pixel_aspect, settings_.fov);
    std::vector<Remark> told_later;
    try {
        return {depth_.plane(frame, nullptr, {}, display_, display_, path.at(frame), told_later), meeting_};
    } catch (const FrameError&) {
        return {{}, meeting_};  // what is wrong with the map is told of the first frame
    }
}

double Shot::frame_bytes(double pixel_bytes) const {
    return static_cast<double>(display_.area()) * pixel_bytes + static_cast<double>(displacer_->instant_bytes());
}

void Shot::tell(const std::vector<int>& frames, bool verbose) {
    warnings_ = displacer_->warnings();
    if (scene_.media.empty()) warnings_.push_back("the scene has no medium: nothing moves");
    if (gain_ != 0)
        for (std::string& line : flat_lattices(scene_)) warnings_.push_back(std::move(line));
    if (displacer_->mirages() && depth_.far_is_unstated() && depth_.far() < kDefaultSky)
        warnings_.push_back(
            fmt::format("the background, which a mirage mirrors, is taken to be {:g} m away{}, for the other media's "
                        "sake: say with "
                        "--far or plate.far how far it is",
                        depth_.far(), depth_.constant() ? "" : ", or where the frame's farthest thing is"));
    if (choice_ && choice_->p95 > *tolerance_)
        warnings_.push_back(
            choice_->exact
                ? fmt::format("--tolerance {:g}: 95 of 100 sampled pixels are off by up to {}, and no medium of "
                              "this scene takes a model; eikonal-trace render follows the rays truly",
                              *tolerance_, shown_error(choice_->p95))
                : fmt::format("--tolerance {:g}: no model stays within it; {} is used, off by up to {} in 95 of "
                              "100 sampled pixels (focusing variance {:.2g}; rays fold near 1): eikonal-trace render "
                              "follows the rays truly",
                              *tolerance_, name_of(choice_->model), shown_error(choice_->p95), focusing_variance()));
    const bool first_order =
        displacer_->models().empty() || displacer_->models().front() != name_of(Model::SecondOrder);
    if (std::abs(gain_) > 1 && first_order)
        if (const double focusing = focusing_variance(); focusing > kFolding)
            warnings_.push_back(
                fmt::format("multiplied by {:.3g}, the air has a focusing variance of {:.2g} at {:g} m: rays fold, and "
                            "the picture tears; "
                            "ask for a smaller --rms or --gain, or for --model second-order",
                            gain_, focusing, depth_.far()));
    const auto [first, last] = std::minmax_element(frames.begin(), frames.end());
    if (scene_.camera.path && !frames.empty()) {
        const CameraPath path(scene_.camera, display_.width, display_.height);
        const auto [from, to] = path.frames();
        if (*first < from || *last > to)
            warnings_.push_back(
                fmt::format("'{}' holds frames {:g} to {:g}, but frames {} to {} are made; outside, its "
                            "first and last camera hold",
                            scene_.camera.path->string(), from, to, *first, *last));
    }
    if (verbose)
        for (const std::string& note : notes()) fmt::print(stderr, "eikonal: {}\n", note);
    for (const std::string& warning : warnings_) fmt::print(stderr, "eikonal: warning: {}\n", warning);
}

std::vector<std::string> Shot::notes() const {
    std::vector<std::string> lines;
    lines.push_back(fmt::format("scene: {}", scene_.file.empty() ? "none" : scene_.file.filename().string()));
    lines.push_back("depth: " + depth_.description());
    for (const std::string& note : displacer_->notes()) lines.push_back(note);
    if (choice_) lines.push_back(describe(*choice_, *tolerance_));
    if (displacer_->mirages() && displacer_->models().empty())
        lines.push_back("displacement: by surfaces alone, exact and not estimated beforehand");
    else
        lines.push_back(fmt::format("displacement: {:.3g} px rms expected at {:g} m, gain {:.4g}{}", expected_rms(),
                                    depth_.far(), gain_, displacer_->mirages() ? ", besides what surfaces move" : ""));
    if (const double focusing = focusing_variance(); focusing > 0)
        lines.push_back(
            fmt::format("focusing variance at {:g} m: {:.3g} (rays begin to fold near 1)", depth_.far(), focusing));
    return lines;
}

std::optional<std::string> Shot::missing_companion(const std::vector<int>& frames) const {
    std::error_code ignored;
    const auto check = [&](const std::optional<FilePattern>& files, const char* what) -> std::optional<std::string> {
        if (!files) return {};
        for (const int frame : frames) {
            const std::filesystem::path file = files->at(frame);
            if (!std::filesystem::exists(file, ignored))
                return fmt::format("frame {}: the {} '{}' does not exist; {}", frame, what, file.string(),
                                   files->is_sequence()
                                       ? "it must have every frame that is warped (--frames names fewer)"
                                       : "check the name");
        }
        return {};
    };
    if (auto missing = check(depth_.files(), "depth map")) return missing;
    return check(mask_, "mask");
}

void Shot::try_companions(int frame, const Picture* input, const std::filesystem::path& input_file,
                          const PixelWindow& window) const {
    std::vector<Remark> ignored;
    try {
        if (!depth_.constant())
            depth_.plane(frame, input, input_file, window, display_, displacer_->camera(frame), ignored);
        if (mask_) read_matte(mask_->at(frame), mask_channel_, window, display_);
    } catch (const FrameError&) {
        // this frame's own trouble, told when its turn comes
    }
}

std::vector<NamedFiles> Shot::companions() const {
    std::vector<NamedFiles> files;
    if (!scene_.file.empty()) files.push_back({"the scene", FilePattern::parse(scene_.file), true});
    if (depth_.files()) files.push_back({"--depth", *depth_.files()});
    if (mask_) files.push_back({"--mask", *mask_});
    return files;
}

Shot::Maps Shot::maps(int frame, const std::vector<double>& offsets, const Picture* input,
                      const std::filesystem::path& input_file, const PixelWindow& window,
                      std::vector<Remark>& remarks) const {
    std::optional<DepthPlane> plane;
    double nearest = depth_.far(), farthest = depth_.far();
    DepthSource source = depth_.constant().value_or(0);
    if (!depth_.constant()) {
        plane.emplace(depth_.plane(frame, input, input_file, window, display_, displacer_->camera(frame), remarks));
        nearest = plane->nearest();
        farthest = plane->farthest();
        source = &*plane;
    } else {
        nearest = farthest = *depth_.constant();
    }
    std::vector<float> mask;
    if (mask_) mask = read_matte(mask_->at(frame), mask_channel_, window, display_, &remarks);
    const PixelWindow seen = seen_from(window, display_);
    Maps result;
    for (std::size_t k = 0; k < offsets.size(); ++k) {
        DisplacementMap map{window, std::vector<float>(2 * window.area())};
        if (gain_ != 0) {
            const Displacer::Instant instant = displacer_->at(frame + offsets[k], nearest, farthest, gain_);
            instant.map(seen, source, meeting_, map.uv.data());
            if (state_errors_ && k == offsets.size() / 2)
                result.error = instant.stated_error(seen, source, meeting_, map.uv.data());
        }
        for (std::size_t i = 0; i < mask.size(); ++i) {
            map.uv[2 * i] *= mask[i];
            map.uv[2 * i + 1] *= mask[i];
        }
        result.of_instants.push_back(std::move(map));
    }
    if (displacer_->mirages() && !depth_.far_is_unstated() && farthest > static_cast<float>(depth_.far()))
        remarks.push_back({"background_behind",
                           fmt::format("depth reaches {:g} m, beyond {} {:g} m: the background, which the mirage "
                                       "mirrors, is put there in this frame; say with a larger far where it is in all",
                                       farthest, depth_.far_name(), depth_.far())});
    if (const std::vector<std::string> lines = displacer_->beyond_far(farthest); !lines.empty())
        remarks.push_back(
            {"depth_far", fmt::format("depth reaches {:g} m, beyond {} {:g} m; {}: say with --far how "
                                      "far the air and the background reach",
                                      farthest, depth_.far_name(), depth_.far(), fmt::join(lines, "; "))});
    return result;
}

MapStatistics statistics(const DisplacementMap& map) {
    double sum = 0, largest = 0;
    for (std::size_t i = 0; i < map.uv.size(); i += 2) {
        const double d2 = double{map.uv[i]} * map.uv[i] + double{map.uv[i + 1]} * map.uv[i + 1];
        sum += d2;
        largest = std::max(largest, d2);
    }
    return {std::sqrt(sum / (0.5 * static_cast<double>(std::max<std::size_t>(map.uv.size(), 2)))), std::sqrt(largest)};
}

void write_displacement(const std::filesystem::path& file, const DisplacementMap& map, const PixelWindow& display) {
    static const std::vector<std::string> names{"u", "v"};
    write_float_exr(file, map.window, display, names, map.uv);
}

void write_stmap(const std::filesystem::path& file, const DisplacementMap& map, const PixelWindow& display) {
    static const std::vector<std::string> names{"R", "G", "B"};
    std::vector<float> st(3 * map.window.area());
    for (int row = 0; row < map.window.height; ++row)
        for (int column = 0; column < map.window.width; ++column) {
            const auto i = static_cast<std::size_t>(row) * static_cast<std::size_t>(map.window.width) +
                           static_cast<std::size_t>(column);
            const double x = map.window.x0 - display.x0 + column + 0.5 + double{map.uv[2 * i]};
            const double y = map.window.y0 - display.y0 + row + 0.5 + double{map.uv[2 * i + 1]};
            st[3 * i] = static_cast<float>(x / display.width);
            st[3 * i + 1] = static_cast<float>(1 - y / display.height);
            st[3 * i + 2] = 1;
        }
    write_float_exr(file, map.window, display, names, st);
}

}  // namespace eikonal
