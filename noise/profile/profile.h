/// Absolute refractive indices in closed form, each used as the only medium. The rays through them are known exactly
/// (PHYSICS.md#closed-forms, *added*). With s = axis·(x - center), r = |x - center|, ρ = distance to the line through
/// center along axis:
///
///     luneburg         n² = 2 - (r/radius)² within the radius, 1 outside: F jumps there
///     fish-eye         n  = n0/(1 + (r/radius)²)
///     linear           n  = n0 + slope·s
///     linear-squared   n² = n0² + slope·s
///     exponential      n  = n0 e^{slope·s}
///     rod              n² = n0² (1 - g²ρ²)
///     sech             n  = n0 sech(gρ)
///
/// Where a formula gives no index (n² <= 0 or n <= 0), `n - 1` is -1 and the derivatives are zero. The index is limited
/// to kLargestIndex. All results are finite for finite input. The axis is of unit length.
#pragma once

#include "noise/math/index_sample.h"
#include "noise/profile/profile_spec.h"

namespace eikonal {

inline constexpr double kLargestIndex = 1e100;

/// Immutable, thread-safe.
class Profile {
  public:
    explicit Profile(const ProfileSpec& spec) : spec_(spec) {}

    /// n - 1 (not n - n_ambient), gradient and Hessian.
    IndexJet jet(const dvec3& x) const;

    /// Length [m] over which the profile changes by its own size. For Luneburg's sphere the distance to it is added. >
    /// 0, may be infinite.
    double scale(const dvec3& x) const;
    /// Distance from x along the unit direction d on which n is constant: before Luneburg's sphere and behind it. 0
    /// elsewhere.
    double clear_way(const dvec3& x, const dvec3& d) const;
    /// Distance to the next place where F jumps: the sphere's surface, or the plane or cylinder at which n vanishes.
    double way_to_edge(const dvec3& x, const dvec3& d) const;

  private:
    ProfileSpec spec_;
};

}  // namespace eikonal
