/// `--model auto`: chooses the cheapest model whose error stays within a tolerance.
///
/// When. The choice is made once a shot. It depends on the scene and on the depth that all frames share, if there is
/// one. Every chunk of the shot's frames therefore makes the same choice, and the picture cannot flicker between
/// models.
///
/// What is sampled. Each model computes kChoiceRows rows of pixels of the first frame. Under a moving camera these are
/// the first, middle and last frame of its path. If the depth is unknown, objects are assumed at the distances far/8,
/// far/4, far/2 and far in turn. Over heated surfaces they are assumed at far alone, with the surfaces in front of
/// them.
///
/// How a model is judged. The models that apply are tried from the cheapest to the dearest. The rows of each are
/// sampled as in stated_error.h. Its p95 is the largest 95th percentile of the error over all frames and distances.
///
/// Which one is taken. The first model with kChoiceMargin × p95 <= tolerance is taken. If there is none, the model of
/// the least p95 is taken. If even that p95 exceeds kHopeless times the rms displacement, no model is good, and the
/// default model is taken because it is quick.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "warp/displace/displacer.h"

namespace eikonal {

/// Each frame and distance is sampled on kChoiceRows rows, at kChoiceSamples pixels in all.
inline constexpr int kChoiceRows = 8, kChoiceSamples = 128;
/// The p95 of a model must be smaller than the tolerance by this factor. Over six scenes of samples/compare/, four
/// seeds and two frames, the p95 that a frame stated for its cheapest good model was 0.13 to 1.28 times the p95 of the
/// choice. The median was 0.7 times.
inline constexpr double kChoiceMargin = 1.3;
inline constexpr double kHopeless = 0.5;

struct TriedModel {
    Model model;
    std::string refusal;  ///< why the model does not apply; empty if it does
    double p95 = 0;       ///< 95th percentile of the error [px]
};

struct ModelChoice {
    std::unique_ptr<Displacer> displacer;
    Model model;
    double p95 = 0;      ///< 95th percentile of the error of that model [px]
    bool within = true;  ///< whether p95 <= tolerance, with or without the margin
    bool exact = false;  ///< whether there is nothing to choose, because no medium takes a model
    std::vector<TriedModel> tried;
};

/// The factor on the displacement. It may depend on how strong the displacement is, which the displacer tells.
using GainOf = std::function<double(const Displacer&)>;

/// Axial depth that every frame of a shot has: one distance [m] > 0 of all objects, or the depth plane of a picture.
using SharedDepth = std::variant<double, DepthPlane>;
struct ShotDepth {
    std::optional<SharedDepth> shared;
    DepthMeeting meeting = DepthMeeting::March;  ///< used with a depth plane
};

/// Chooses the model of a shot. settings.model is not read. tolerance [px] > 0.
/// UserError as the constructor of Displacer, if not even second-order applies.
ModelChoice choose_model(const Scene& scene, DisplacerSettings settings, double tolerance, const ShotDepth& depth,
                         const GainOf& gain_of);

/// A better model for frames in which `model` has turned out to be off by `p95` [px]: the cheapest of the dearer models
/// that should keep them within the tolerance. The error of a dearer model in those frames is estimated as p95 times
/// the ratio of its error to that of `model` in the samples of choose_model(). Nothing if no model should suffice. The
/// other arguments are those of choose_model().
std::optional<Model> sufficient_model(const Scene& scene, DisplacerSettings settings, double tolerance,
                                      const ShotDepth& depth, const GainOf& gain_of, Model model, double p95);

}  // namespace eikonal
