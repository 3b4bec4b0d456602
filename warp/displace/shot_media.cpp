#include "warp/displace/shot_media.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "noise/base/memory.h"
#include "noise/medium/optics.h"
#include "warp/displace/media/any_medium/any_medium_bend.h"
#include "warp/displace/media/blobs/blobs_bend.h"
#include "warp/displace/media/gradient_noise/gradient_noise_bend.h"
#include "warp/displace/media/lattice/lattice_bend.h"
#include "warp/displace/media/screens/screens_bend.h"
#include "warp/scene/shot_view.h"

namespace eikonal {
namespace {

/// Objects deeper than `far` may be displaced by up to this factor more than objects at `far`. A path 100 times as long
/// gives this factor.
constexpr double kDeeper = 10;
/// Largest value of a Gaussian field over a shot, divided by its rms.
constexpr double kLargestOverRms = 6;

/// The only list of the kinds of medium that have a quicker way in the warp than AnyMediumBend.
std::unique_ptr<const MediumBend> make_medium_bend(const ShotContext& shot, std::size_t i,
                                                   const std::shared_ptr<const Medium>& medium) {
    if (auto screens = std::dynamic_pointer_cast<const ScreensMedium>(medium))
        return std::make_unique<const ScreensBend>(shot, i, std::move(screens));
    if (auto lattice = std::dynamic_pointer_cast<const LatticeMedium>(medium))
        return std::make_unique<const LatticeBend>(shot, i, std::move(lattice));
    if (auto noise = std::dynamic_pointer_cast<const GradientNoiseMedium>(medium))
        return std::make_unique<const GradientNoiseBend>(shot, i, std::move(noise));
    if (auto blobs = std::dynamic_pointer_cast<const BlobsMedium>(medium))
        return std::make_unique<const BlobsBend>(shot, i, std::move(blobs));
    return std::make_unique<const AnyMediumBend>(shot, i, medium);
}

/// Why a medium that bends light moves no visible pixel; empty if it may move one.
std::string why_unseen(const ShotContext& shot, const Medium& medium) {
    if (const auto* blobs = dynamic_cast<const BlobsMedium*>(&medium)) return BlobsBend::why_unseen(shot, *blobs);
    return {};
}

void append(std::vector<std::string>& to, const std::vector<std::string>& lines) {
    to.insert(to.end(), lines.begin(), lines.end());
}

}  // namespace

std::shared_ptr<const Air> build_shot_air(const Scene& scene, const DisplacerSettings& settings,
                                          const CameraPath& path) {
    for (std::size_t i = 0; i < scene.media.size(); ++i)
        if (scene.media[i].has_absolute_index())
            throw UserError(fmt::format(
                "medium.{}: a medium of type \"{}\" is there to validate the tracer, which takes it: eikonal-trace "
                "render; remove it from the scene that you warp with",
                i, scene.media[i].type()));
    const ShotFrame frame = shot_frame(path.reference(), settings.width, settings.height, scene.optics.aperture,
                                       settings.far, settings.fps);
    return std::make_shared<const Air>(
        scene.media, scene.optics, AirSettings{frame, memory_limit(), std::numeric_limits<double>::infinity(), false});
}

ShotMedia::ShotMedia(const Scene& scene, const DisplacerSettings& settings, const CameraPath& path,
                     std::shared_ptr<const Air> air)
    : shot_{scene,
            settings,
            path,
            path.reference(),
            force_strength(scene.optics),
            {scene.optics.ray_equation, index_law(scene.optics).ambient(), scene.optics.exaggeration}},
      air_(air ? std::move(air) : build_shot_air(scene, settings, path)) {
    auto built = air_->media().begin();
    for (std::size_t i = 0; i < scene.media.size(); ++i) {
        if (built != air_->media().end() && built->index == i)
            add(i, (built++)->medium);
        else
            notes_.push_back(fmt::format("medium.{}: {}", i, air_->medium_notes()[i]));
    }
    air_warnings_ = air_->warnings();
    check_surfaces(reference_mirages_, surface_names_);
    refuse_other_model();
}

void ShotMedia::add(std::size_t i, const std::shared_ptr<const Medium>& medium) {
    if (auto surface = std::dynamic_pointer_cast<const SurfaceMedium>(medium))
        return add_surface(i, std::move(surface));
    if (const std::string unseen = why_unseen(shot_, *medium); !unseen.empty()) {
        notes_.push_back(fmt::format("medium.{}: left out, {}", i, unseen));
        return;
    }
    std::unique_ptr<const MediumBend> bend = make_medium_bend(shot_, i, medium);
    append(notes_, bend->told().first_notes);
    append(warnings_, bend->told().first_warnings);
    keep(std::move(bend));
}

void ShotMedia::keep(std::unique_ptr<const MediumBend> bend) {
    const DisplacerSettings& settings = shot_.settings;
    if (!bend->is_seen_for_sure()) {
        double rms = std::sqrt(bend->expected_variance(settings.far, true));
        if (!(rms <= kLargestShift))
            throw UserError(fmt::format(
                "medium.{}: it would move pixels by {:.2g} px rms, and a map holds at most {:g} px; lower its cn2 or "
                "strength, optics.exaggeration, or `far`",
                bend->medium(), rms, kLargestShift));
        // Rays in the corners of a wide view cross more air, and their bend shows larger.
        const double more = bend->corner_gain() * (shot_.deepest() > settings.far ? kDeeper : 1);
        const auto negligible = [&] { return kLargestOverRms * rms * more < settings.negligible; };
        // A moving camera may zoom in later.
        if (!shot_.camera_moves() && negligible()) rms = std::sqrt(bend->expected_variance(settings.far, false));
        if (!shot_.camera_moves() && negligible()) {
            notes_.push_back(fmt::format("medium.{}: left out, it moves no pixel by more than {:g} px ({:.2g} px rms)",
                                         bend->medium(), settings.negligible, rms));
            return;
        }
    }
    notes_.push_back(bend->told().note);
    append(notes_, bend->told().last_notes);
    warn_of_folding(*bend);
    append(warnings_, bend->told().last_warnings);
    bends_.push_back(std::move(bend));
}

void ShotMedia::warn_of_folding(const MediumBend& bend) {
    const double far = shot_.settings.far, focusing = bend.focusing_variance(far);
    if (focusing > kFolding && !second_order())
        warnings_.push_back(
            fmt::format("medium.{}: focusing variance {:.2g} at {:g} m: rays fold, where any first-order warp is only "
                        "plausible; weaken the medium, shorten the distance, or widen the aperture",
                        bend.medium(), focusing, far));
    if (focusing > kHopelessFolding && second_order())
        warnings_.push_back(
            fmt::format("medium.{}: focusing variance {:.2g} at {:g} m: rays fold many times over, which no warp can "
                        "show; weaken the medium or shorten the distance; eikonal-trace render follows the rays truly",
                        bend.medium(), focusing, far));
}

void ShotMedia::check_camera_stays_above(std::size_t i, const GroundPlane& ground) const {
    if (!shot_.camera_moves()) return;
    const auto [first, last] = shot_.path.frames();
    for (double frame = first; frame <= last; ++frame)
        if (const double height = ground.height(shot_.path.at(frame).position); !(height > 0))
            throw UserError(fmt::format(
                "medium.{}.origin: the camera's path is {:g} m below this surface at frame {:g}; it must be above it "
                "in every frame: lower the surface, or turn its normal towards the camera",
                i, 0.0 - height, frame));
}

void ShotMedia::add_surface(std::size_t i, std::shared_ptr<const SurfaceMedium> medium) {
    const std::string name = fmt::format("medium.{}", i);
    check_camera_stays_above(i, *medium->ground());
    const OpticsSpec& optics = shot_.scene.optics;
    Mirage mirage(medium->spec(), index_law(optics), optics.exaggeration, optics.ray_equation, shot_.reference,
                  shot_.deepest(), name);
    if (!shot_.camera_moves() && !mirage.touches(shot_.picture())) {
        notes_.push_back(fmt::format("{}: left out, it moves no pixel of the view by more than {:g} px up to {:g} m",
                                     name, kMirageThreshold, shot_.deepest()));
        return;
    }
    const double height = medium->index().height(shot_.reference.position);
    const double critical = medium->index().critical_slope(height, optics.exaggeration, optics.ray_equation);
    notes_.push_back(
        critical > 0
            ? fmt::format("{}: exact bending over a hot surface: rays less than {:.3g} mrad below it turn back, seen "
                          "from {:.3g} m up that is beyond {:.3g} m",
                          name, 1e3 * critical, height, height / critical)
            : fmt::format("{}: exact bending over a cold surface, seen from {:.3g} m up", name, height));
    surfaces_.push_back({i, std::move(medium)});
    surface_names_.push_back(name);
    reference_mirages_.push_back(std::move(mirage));
}

std::vector<Mirage> ShotMedia::mirages(const Camera& camera, double farthest) const {
    const OpticsSpec& optics = shot_.scene.optics;
    std::vector<Mirage> result;
    for (const Surface& surface : surfaces_)
        result.emplace_back(surface.medium->spec(), index_law(optics), optics.exaggeration, optics.ray_equation, camera,
                            farthest, fmt::format("medium.{}", surface.index));
    return result;
}

std::vector<std::unique_ptr<const BendInstant>> ShotMedia::at(const FrameView& frame) const {
    std::vector<std::unique_ptr<const BendInstant>> instants;
    for (const auto& bend : bends_) instants.push_back(bend->at(frame));
    return instants;
}

namespace {

/// The nearest and farthest depth and all depths between them, sorted, without repetition.
std::vector<double> joint_depths(std::vector<double> depths, double nearest, double farthest) {
    std::erase_if(depths, [&](double z) { return z <= nearest || z >= farthest; });
    depths.push_back(nearest);
    if (farthest > nearest) depths.push_back(farthest);
    std::sort(depths.begin(), depths.end());
    depths.erase(std::unique(depths.begin(), depths.end()), depths.end());
    return depths;
}

}  // namespace

BentRays ShotMedia::bent_rays(const std::vector<std::unique_ptr<const BendInstant>>& own, const FrameView& frame,
                              bool judge) const {
    const DisplacerSettings& settings = shot_.settings;
    // If all media choose their own steps, the factor on the step is given to them.
    const bool own_steps = std::all_of(own.begin(), own.end(), [](const auto& i) { return i->chooses_own_steps(); });
    double cell = std::numeric_limits<double>::infinity();
    double step = second_order() && judge ? kFineStep : kStep;
    std::vector<AirPart> parts;
    NodeLayout nodes;
    for (const auto& instant : own) {
        const InstantSettings look{shot_.law, frame.gain, own_steps ? step : 1, instant->reach(!second_order())};
        parts.push_back({instant->air(look), frame.gain});
        step = std::min(step, instant->bent_step());
        const NodeLayout layout = instant->layout();
        nodes.spacing = std::min(nodes.spacing, layout.spacing);
        nodes.depths.insert(nodes.depths.end(), layout.depths.begin(), layout.depths.end());
        if (const auto cells = instant->averaged_cells()) cell = std::min({cell, cells->x, cells->y, cells->z});
    }
    if (judge)
        for (const Surface& surface : surfaces_)
            parts.push_back({surface.medium->at(frame.t, {.law = shot_.law, .step = kSurfaceStep})});
    if (own_steps && !own.empty()) step = 1;
    return {AirInstant(shot_.law, std::move(parts)),
            step,
            nodes.spacing,
            joint_depths(std::move(nodes.depths), frame.nearest, frame.farthest),
            std::isfinite(cell) ? shot_.scene.optics.aperture : 0,
            cell,
            settings.far,
            settings.stop};
}

std::uint64_t ShotMedia::instant_bytes() const {
    double bytes = 0;
    for (const auto& bend : bends_) bytes += bend->instant_bytes();
    return static_cast<std::uint64_t>(std::min(bytes, 1e18));
}

std::vector<std::string> ShotMedia::beyond_far(double farthest) const {
    std::vector<std::string> lines;
    if (!is_beyond(farthest, shot_.settings.far)) return lines;
    for (const auto& bend : bends_) append(lines, bend->beyond_far(farthest));
    return lines;
}

void ShotMedia::refuse_other_model() const {
    if (!shot_.settings.model || bends_.empty()) return;
    std::string have;
    for (const auto& bend : bends_) {
        if (bend->model() == *shot_.settings.model) return;
        have += fmt::format("{}medium.{}: {}", have.empty() ? "" : ", ", bend->medium(), name_of(bend->model()));
    }
    throw UserError(fmt::format(
        "`model` {}: no medium of this scene suits it ({}); screens goes with form=\"screens\", the others with "
        "form=\"lattice\" (`set` medium.0.form=lattice)",
        name_of(*shot_.settings.model), have));
}

}  // namespace eikonal
