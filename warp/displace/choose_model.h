/// `--model auto`: the cheapest model whose error stays within a tolerance.
///
/// The choice is made once a shot, of the scene and of the depth that all its frames share, if they do, so that every
/// chunk of its frames makes the same one and it cannot flicker: at the shot's first frame (under a moving camera also
/// at the middle and the end of its path), on kChoiceRows rows of pixels. Where nothing is known of the depth every row
/// is for objects at each of the distances far/8, far/4, far/2 and far, or over heated surfaces at far alone, which
/// these are then before. Each model
/// that applies is tried, cheapest first, and its map is sampled as stated_error.h says: its p95 is the largest 95th
/// percentile of any frame and distance. The first that is within the tolerance with kChoiceMargin to spare is taken.
/// If none is, it is the one of the least error or, where even that is off by more than kHopeless of the rms
/// displacement, the default: no time is spent on what is wrong anyway.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "warp/displace/displacer.h"

namespace eikonal {

/// Samples are of one distance and frame, spread over the rows.
inline constexpr int kChoiceRows = 8, kChoiceSamples = 128;
/// So many times its p95 must be within the tolerance. Over six scenes of samples/compare/, four seeds and two frames
/// the p95 that a frame stated of its cheapest good model was 0.13 to 1.28 times that of the choice, half of them 0.7.
inline constexpr double kChoiceMargin = 1.3;
inline constexpr double kHopeless = 0.5;

struct TriedModel {
    Model model;
    std::string refusal;  ///< why it does not apply; empty if it does
    double p95 = 0;       ///< [px]
};

struct ModelChoice {
    std::unique_ptr<Displacer> displacer;
    Model model;
    double p95 = 0;      ///< of the model chosen [px]
    bool within = true;  ///< the tolerance, with the margin or without
    bool exact = false;  ///< nothing to choose: no medium takes a model
    std::vector<TriedModel> tried;
};

/// What multiplies the displacement, once a displacer is there to say how strong it is.
using GainOf = std::function<double(const Displacer&)>;

/// Axial depth of what every frame of a shot sees: one distance [m] > 0, or a picture's.
using SharedDepth = std::variant<double, DepthPlane>;
struct ShotDepth {
    std::optional<SharedDepth> shared;
    DepthMeeting meeting = DepthMeeting::March;  ///< of a picture's
};

/// settings.model is not read. tolerance [px] > 0.
/// UserError as Displacer's, if not even second-order applies.
ModelChoice choose_model(const Scene& scene, DisplacerSettings settings, double tolerance, const ShotDepth& depth,
                         const GainOf& gain_of);

/// For frames that `model` is off by `p95` [px] in: the cheapest of the models dearer than that which should keep them
/// within the tolerance, by what both are off by in the samples of a choice; nothing if none should. The arguments as
/// above.
std::optional<Model> sufficient_model(const Scene& scene, DisplacerSettings settings, double tolerance,
                                      const ShotDepth& depth, const GainOf& gain_of, Model model, double p95);

}  // namespace eikonal
