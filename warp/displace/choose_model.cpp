#include "warp/displace/choose_model.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <optional>
#include <variant>

#include "noise/base/error.h"
#include "noise/medium/medium_spec.h"
#include "noise/surface/surface_spec.h"
#include "warp/displace/grid/ray_frame.h"
#include "warp/displace/stated_error.h"
#include "warp/pixels/depth_range.h"
#include "warp/scene/background.h"

namespace eikonal {
namespace {

std::vector<double> choice_frames(const Scene& scene, const DisplacerSettings& settings) {
    if (!scene.camera.path) return {static_cast<double>(scene.time.first_frame)};
    const auto [first, last] = CameraPath(scene.camera, settings.width, settings.height).frames();
    return {first, 0.5 * (first + last), last};
}

/// Depth of a picture that shows objects at `distance` [m], and heated surfaces where these are nearer.
DepthPlane ground_before(const Camera& camera, const Scene& scene, const PixelWindow& window, double distance) {
    std::vector<float> metres(window.area(), static_cast<float>(distance));
    for (const MediumSpec& medium : scene.media) {
        const std::optional<GroundPlane> ground = medium.mirage_ground(scene.optics);
        if (!ground) continue;
        auto z = metres.begin();
        for (int y = window.y0; y < window.y0 + window.height; ++y)
            for (int x = window.x0; x < window.x0 + window.width; ++x, ++z) {
                const StraightRay ray = straight_ray(camera, x + 0.5, y + 0.5);
                const double way = -ground->height(ray.origin) / glm::dot(ray.direction, ground->normal);
                if (way > kNearestDepth && way < double{*z}) *z = static_cast<float>(way);
            }
    }
    return {window, std::move(metres)};
}

/// Depths that stand for those of a shot: a depth plane if the frames share one, else distances [m].
struct ChoiceDepths {
    const DepthPlane* plane = nullptr;
    DepthMeeting meeting = DepthMeeting::March;
    std::vector<double> distances;
    bool over_ground = false;  ///< heated surfaces are put in front of the distances

    ChoiceDepths(const Scene& scene, double far, const ShotDepth& depth) : meeting(depth.meeting), distances{far} {
        if (!depth.shared) {
            over_ground = has_mirage(scene);
            if (!over_ground) distances = {far / 8, far / 4, far / 2, far};
        } else if (const auto* distance = std::get_if<double>(&*depth.shared)) {
            distances = {*distance};
        } else {
            plane = &std::get<DepthPlane>(*depth.shared);
        }
    }
};

/// The largest 95th percentile of the error over the frames and distances [px].
double sampled_p95(const Displacer& displacer, const Scene& scene, const DisplacerSettings& settings,
                   const ChoiceDepths& depths, double gain) {
    double worst = 0;
    std::vector<float> uv(2 * static_cast<std::size_t>(settings.width));
    for (const double frame : choice_frames(scene, settings)) {
        for (const double distance : depths.distances) {
            const DepthPlane* plane = depths.plane;
            std::optional<DepthPlane> ground;
            if (depths.over_ground) {
                const PixelWindow picture{0, 0, settings.width, settings.height};
                plane = &ground.emplace(ground_before(displacer.camera(frame), scene, picture, distance));
            }
            const double nearest = plane ? double{plane->nearest()} : depths.distances.front();
            const double farthest = plane ? double{plane->farthest()} : depths.distances.back();
            const Displacer::Instant instant = displacer.at(frame, nearest, farthest, gain);
            const DepthSource depth = plane ? DepthSource(plane) : DepthSource(distance);
            std::vector<double> errors;
            for (int r = 0; r < kChoiceRows; ++r) {
                const PixelWindow row{0, (2 * r + 1) * settings.height / (2 * kChoiceRows), settings.width, 1};
                instant.map(row, depth, depths.meeting, uv.data());
                const std::vector<double> some =
                    instant.sampled_errors(row, depth, depths.meeting, uv.data(), kChoiceSamples / kChoiceRows);
                errors.insert(errors.end(), some.begin(), some.end());
            }
            worst = std::max(worst, statistics_of(std::move(errors)).p95);
        }
    }
    return worst;
}

}  // namespace

ModelChoice choose_model(const Scene& scene, DisplacerSettings settings, double tolerance, const ShotDepth& depth,
                         const GainOf& gain_of) {
    settings.sample_errors = true;
    const ChoiceDepths depths(scene, settings.far, depth);
    ModelChoice choice{};
    double rms = 0;
    std::shared_ptr<const Air> air;  // built once for all models
    for (const auto& [name, model] : kModelNames) {
        settings.model = model;
        std::unique_ptr<Displacer> displacer;
        try {
            displacer = std::make_unique<Displacer>(scene, settings, air);
            air = displacer->air();
        } catch (const UserError& refusal) {
            if (model == kModelNames.back().second && !choice.displacer) throw;
            choice.tried.push_back({model, refusal.what()});
            continue;
        }
        const double gain = gain_of(*displacer);
        double p95 = 0;
        try {
            p95 = sampled_p95(*displacer, scene, settings, depths, gain);
        } catch (const FrameError& refusal) {
            check_stop(settings.stop);
            choice.tried.push_back({model, refusal.what()});
            continue;
        }
        choice.tried.push_back({model, "", p95});
        rms = displacer->expected_rms(settings.far) * std::abs(gain);
        if (!choice.displacer || p95 < choice.p95) {
            choice.displacer = std::move(displacer);
            choice.model = model;
            choice.p95 = p95;
        }
        choice.within = choice.p95 <= tolerance;
        choice.exact = choice.displacer->models().empty();
        if (kChoiceMargin * choice.p95 <= tolerance || choice.exact) break;
    }
    if (choice.displacer && (choice.within || choice.exact || choice.p95 <= kHopeless * rms)) return choice;
    choice.within = false;
    settings.model.reset();
    choice.displacer = std::make_unique<Displacer>(scene, settings, air);
    for (const auto& [name, model] : kModelNames)
        if (choice.displacer->models().front() == name) choice.model = model;
    for (const TriedModel& tried : choice.tried)
        if (tried.model == choice.model && tried.refusal.empty()) choice.p95 = tried.p95;
    return choice;
}

std::optional<Model> sufficient_model(const Scene& scene, DisplacerSettings settings, double tolerance,
                                      const ShotDepth& depth, const GainOf& gain_of, Model model, double p95) {
    settings.sample_errors = true;
    const ChoiceDepths depths(scene, settings.far, depth);
    double own = 0;
    std::shared_ptr<const Air> air;
    for (const auto& [name, other] : kModelNames) {
        if (other < model) continue;
        settings.model = other;
        try {
            const Displacer displacer(scene, settings, air);
            air = displacer.air();
            if (displacer.models().empty()) return {};
            const double sampled = sampled_p95(displacer, scene, settings, depths, gain_of(displacer));
            if (other == model)
                own = sampled;
            else if (std::isfinite(sampled) && p95 * sampled <= tolerance * own)
                return other;
        } catch (const UserError&) {
            continue;  // the model does not apply
        }
    }
    return {};
}

}  // namespace eikonal
