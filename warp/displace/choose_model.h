/// `--model auto`: the cheapest model whose error stays within a tolerance.
///
/// The choice is made once a shot, of the scene alone, so that every chunk of its frames makes the same one and it
/// cannot flicker: at the shot's first frame (under a moving camera also at the middle and the end of its path), on
/// kChoiceRows rows of pixels, every one of them for objects at each of the distances far/8, far/4, far/2 and far, or
/// at far alone where the footage is all at one distance. Each model that applies is tried, cheapest first, and its map
/// is sampled as stated_error.h says; the first whose 95th percentile is within the tolerance is taken. If none is, it
/// is the one of the least error or, where even that is off by more than kHopeless of the rms displacement, the
/// default: no time is spent on what is wrong anyway.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "warp/displace/displacer.h"

namespace eikonal {

inline constexpr int kChoiceRows = 4;
inline constexpr double kHopeless = 0.5;

struct TriedModel {
    Model model;
    std::string refusal;  ///< why it does not apply; empty if it does
    double p95 = 0;       ///< [px]
};

struct ModelChoice {
    std::unique_ptr<Displacer> displacer;
    Model model;
    double p95 = 0;  ///< of the model chosen [px]
    bool within = true;
    bool exact = false;  ///< nothing to choose: no medium takes a model
    std::vector<TriedModel> tried;
};

/// What multiplies the displacement, once a displacer is there to say how strong it is.
using GainOf = std::function<double(const Displacer&)>;

/// settings.model is not read. tolerance [px] > 0; one_distance: every object is at settings.far.
/// UserError as Displacer's, if not even second-order applies.
ModelChoice choose_model(const Scene& scene, DisplacerSettings settings, double tolerance, bool one_distance,
                         const GainOf& gain_of);

}  // namespace eikonal
