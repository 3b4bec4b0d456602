/// How the strength of turbulence falls with height above a heat source, and the product with a field's own values.
/// Theory: PHYSICS.md#turbulence.
#pragma once

#include <optional>

#include "noise/math/index_sample.h"
#include "noise/turbulence/parameters/turbulence_spec.h"

namespace eikonal {

/// g and ∇g [1/m] of a falloff at x.
IndexSample falloff_at(const Falloff& falloff, const dvec3& x);
/// With the second derivatives [1/m²].
IndexJet falloff_jet(const Falloff& falloff, const dvec3& x);
/// The product with a field's own values at x.
IndexSample with_falloff(const std::optional<Falloff>& falloff, const dvec3& x, const IndexSample& field);
IndexJet with_falloff(const std::optional<Falloff>& falloff, const dvec3& x, const IndexJet& field);

}  // namespace eikonal
