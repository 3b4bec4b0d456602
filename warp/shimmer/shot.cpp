#include "warp/shimmer/shot.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "noise/base/error.h"
#include "warp/displace/stated_error.h"
#include "warp/shimmer/depth_input.h"

namespace eikonal {
namespace {

/// The factor on the displacement.
double gain_for(const Displacer& displacer, const StrengthSettings& strength, double far) {
    if (!strength.rms) return strength.gain;
    const double natural = displacer.expected_rms(far);
    if (natural == 0 && *strength.rms > 0)
        throw UserError(
            fmt::format("`rms` {:g}: the scene moves nothing that could be scaled to it; give turbulence some strength "
                        "(cn2), and its lattice, if it has one, 4 samples or more in x, y and z, or bring blobs into "
                        "the view, before the plate",
                        *strength.rms));
    return natural > 0 ? strength.gain * *strength.rms / natural : 0;
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

std::vector<double> shutter_offsets(double shutter, int samples) {
    std::vector<double> offsets;
    for (int i = 0; i < samples; ++i) offsets.push_back(shutter * ((i + 0.5) / samples - 0.5));
    return offsets;
}

CameraPath camera_path(const Scene& scene, const ViewSettings& view) {
    return {scene.camera, view.display.width, view.display.height, view.pixel_aspect, view.fov};
}

Shot::Shot(Scene scene, const ShotSettings& settings)
    : scene_(std::move(scene)), settings_(settings), tolerance_(settings.strength.tolerance) {
    const StrengthSettings& strength = settings_.strength;
    settings_.state_errors = settings_.state_errors || strength.tolerance || strength.model.automatic;
    displacer_settings_ = make_displacer_settings();
    if (strength.model.automatic || (strength.tolerance && !strength.model.model)) {
        if (!tolerance_) tolerance_ = kDefaultTolerance;
        choice_ = choose_model(scene_, displacer_settings_, *tolerance_, settings_.depth, gain_of());
        displacer_ = std::move(choice_->displacer);
    } else {
        displacer_ = std::make_unique<Displacer>(scene_, displacer_settings_);
    }
    gain_ = gain_of()(*displacer_);
}

DisplacerSettings Shot::make_displacer_settings() const {
    const ViewSettings& view = settings_.view;
    const StrengthSettings& strength = settings_.strength;
    DisplacerSettings d;
    d.width = view.display.width;
    d.height = view.display.height;
    d.pixel_aspect = view.pixel_aspect;
    d.fps = scene_.time.fps.value_or(view.fps.value_or(kDefaultFps));
    d.fov = view.fov;
    d.far = settings_.background.far;
    d.deepest = settings_.background.deepest;
    d.overscan = view.overscan;
    d.model = strength.model.model;
    d.sample_errors = settings_.state_errors;
    d.stop = settings_.stop;
    // A scale to an rms may enlarge even the weakest displacement, so nothing is negligible.
    d.negligible = strength.rms || strength.gain == 0 ? 0 : kNegligibleShift / std::abs(strength.gain);
    return d;
}

GainOf Shot::gain_of() const {
    return [this](const Displacer& displacer) {
        return gain_for(displacer, settings_.strength, settings_.background.far);
    };
}

std::optional<Model> Shot::sufficient_model(double p95) const {
    if (displacer_->models().empty()) return {};
    const Model model = choice_ ? choice_->model : settings_.strength.model.model.value_or(Model::SecondOrder);
    return eikonal::sufficient_model(scene_, displacer_settings_, *tolerance_, settings_.depth, gain_of(), model, p95);
}

double Shot::frame_bytes(double pixel_bytes) const {
    return static_cast<double>(display().area()) * pixel_bytes + static_cast<double>(displacer_->instant_bytes());
}

std::vector<std::string> Shot::notes() const {
    std::vector<std::string> lines;
    lines.push_back(fmt::format("scene: {}", scene_.file.empty() ? "none" : scene_.file.filename().string()));
    for (const std::string& note : displacer_->notes()) lines.push_back(note);
    if (choice_) lines.push_back(describe(*choice_, *tolerance_));
    if (displacer_->mirages() && displacer_->models().empty())
        lines.push_back("displacement: by surfaces alone, exact and not estimated beforehand");
    else
        lines.push_back(fmt::format("displacement: {:.3g} px rms expected at {:g} m, gain {:.4g}{}", expected_rms(),
                                    background().far, gain_,
                                    displacer_->mirages() ? ", besides what surfaces move" : ""));
    if (const double focusing = focusing_variance(); focusing > 0)
        lines.push_back(
            fmt::format("focusing variance at {:g} m: {:.3g} (rays begin to fold near 1)", background().far, focusing));
    return lines;
}

std::vector<std::string> Shot::warnings(const std::vector<int>& frames) const {
    std::vector<std::string> lines = displacer_->warnings();
    if (scene_.media.empty()) lines.push_back("the scene has no medium: nothing moves");
    if (gain_ != 0) lines.insert(lines.end(), displacer_->air_warnings().begin(), displacer_->air_warnings().end());
    for (const auto& line : {background_warning(), tolerance_warning(), folding_warning(), path_warning(frames)})
        if (line) lines.push_back(*line);
    return lines;
}

std::optional<std::string> Shot::background_warning() const {
    const double far = background().far;
    if (!displacer_->mirages() || background().stated || !(far < kDefaultSky)) return {};
    const bool constant = settings_.depth.shared && std::holds_alternative<double>(*settings_.depth.shared);
    return fmt::format(
        "the background, which a mirage mirrors, is taken to be {:g} m away{}, for the other media's "
        "sake: say with `far` or plate.far how far it is",
        far, constant ? "" : ", or where the frame's farthest thing is");
}

std::optional<std::string> Shot::tolerance_warning() const {
    if (!choice_ || !(choice_->p95 > *tolerance_)) return {};
    if (choice_->exact)
        return fmt::format(
            "`tolerance` {:g}: 95 of 100 sampled pixels are off by up to {}, and no medium of "
            "this scene takes a model; eikonal-trace render follows the rays truly",
            *tolerance_, shown_error(choice_->p95));
    return fmt::format(
        "`tolerance` {:g}: no model stays within it; {} is used, off by up to {} in 95 of "
        "100 sampled pixels (focusing variance {:.2g}; rays fold near 1): eikonal-trace render "
        "follows the rays truly",
        *tolerance_, name_of(choice_->model), shown_error(choice_->p95), focusing_variance());
}

std::optional<std::string> Shot::folding_warning() const {
    const std::vector<std::string> models = displacer_->models();
    const bool first_order = models.empty() || models.front() != name_of(Model::SecondOrder);
    if (!(std::abs(gain_) > 1) || !first_order) return {};
    const double focusing = focusing_variance();
    if (!(focusing > kFolding)) return {};
    return fmt::format(
        "multiplied by {:.3g}, the air has a focusing variance of {:.2g} at {:g} m: rays fold, and the picture tears; "
        "ask for a smaller `rms` or `gain`, or for `model` second-order",
        gain_, focusing, background().far);
}

std::optional<std::string> Shot::path_warning(const std::vector<int>& frames) const {
    if (!scene_.camera.path || frames.empty()) return {};
    const auto [first, last] = std::minmax_element(frames.begin(), frames.end());
    const auto [from, to] = CameraPath(scene_.camera, display().width, display().height).frames();
    if (!(*first < from) && !(*last > to)) return {};
    return fmt::format(
        "'{}' holds frames {:g} to {:g}, but frames {} to {} are made; outside, its "
        "first and last camera hold",
        scene_.camera.path->string(), from, to, *first, *last);
}

void Shot::map(double frame, const SharedDepth& depth, const PixelWindow& window, float* uv) const {
    const DepthRange range = range_of(depth);
    displacer_->at(frame, range.nearest, range.farthest, gain_).map(window, range.source, meeting(), uv);
}

StatedError Shot::stated_error(double frame, const SharedDepth& depth, const PixelWindow& window,
                               const float* uv) const {
    const DepthRange range = range_of(depth);
    return displacer_->at(frame, range.nearest, range.farthest, gain_)
        .stated_error(window, range.source, meeting(), uv);
}

Shot::Maps Shot::maps(double frame, const std::vector<double>& offsets, const SharedDepth& depth,
                      const PixelWindow& window, std::span<const float> matte, std::vector<Remark>& remarks,
                      const Progress& progress) const {
    const DepthRange range = range_of(depth);
    const PixelWindow seen = seen_from(window, display());
    Maps result;
    for (std::size_t k = 0; k < offsets.size(); ++k) {
        DisplacementMap map{window, std::vector<float>(2 * window.area())};
        if (gain_ != 0) {
            const Displacer::Instant instant = displacer_->at(frame + offsets[k], range.nearest, range.farthest, gain_);
            instant.map(seen, range.source, meeting(), map.uv.data());
            if (settings_.state_errors && k == offsets.size() / 2)
                result.error = instant.stated_error(seen, range.source, meeting(), map.uv.data());
        }
        for (std::size_t i = 0; i < matte.size(); ++i) {
            map.uv[2 * i] *= matte[i];
            map.uv[2 * i + 1] *= matte[i];
        }
        result.of_instants.push_back(std::move(map));
        if (progress) progress(static_cast<int>(k) + 1, static_cast<int>(offsets.size()));
    }
    add_remarks(range.farthest, remarks);
    return result;
}

void Shot::add_remarks(double farthest, std::vector<Remark>& remarks) const {
    const Background& b = background();
    if (displacer_->mirages() && b.stated && farthest > static_cast<float>(b.far))
        remarks.push_back({"background_behind",
                           fmt::format("depth reaches {:g} m, beyond {} {:g} m: the background, which the mirage "
                                       "mirrors, is put there in this frame; say with a larger far where it is in all",
                                       farthest, b.stated_by(), b.far)});
    if (const std::vector<std::string> lines = displacer_->beyond_far(farthest); !lines.empty())
        remarks.push_back({"depth_far", fmt::format("depth reaches {:g} m, beyond {} {:g} m; {}: say with `far` how "
                                                    "far the air and the background reach",
                                                    farthest, b.stated_by(), b.far, fmt::join(lines, "; "))});
}

}  // namespace eikonal
