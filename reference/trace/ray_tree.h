/// The paper's ray tree: the radiance that comes along a bent ray, with what mirrors and glass send it from elsewhere.
///
/// At a surface, `mirror` of the light is reflected, the rest is matte (shading.h). A surface of glass
/// (`refractive_index`) reflects the part that Fresnel's equations for unpolarised light give, and refracts the rest by
/// Snell's law: the part of p along the surface is the same on both sides, |p| is the index. Reflected and refracted
/// rays go on bent. Within glass there is no air: rays are straight, until they leave it by its own surface.
///
/// A branch ends at kDeepestBranch surfaces or when less than kFaintest of its light can reach the pixel, and is then
/// black. Rays that have no end (BentHit::ended) are black, too.
#pragma once

#include "reference/trace/bent_ray.h"
#include "reference/trace/cancel.h"
#include "reference/trace/shading.h"

namespace eikonal::reference {

class Shadowgraph;

inline constexpr int kDeepestBranch = 12;
inline constexpr double kFaintest = 1e-3;

/// Immutable; its arguments must outlive it.
class RayTree {
  public:
    /// field: null for straight rays. sunlight: null for straight sunlight.
    RayTree(const Geometry& geometry, const Shading& shading, const AirInstant* field, const Shadowgraph* sunlight,
            Cancelled cancelled)
        : geometry_(geometry), shading_(shading), field_(field), sunlight_(sunlight), cancelled_(cancelled) {}

    /// direction: of any length. trace: how its ray and all that follow are traced; of straight ones nothing is read.
    /// Nothing if the ray itself has no end. FrameError: cancelled.
    std::optional<dvec3> radiance(const dvec3& origin, const dvec3& direction, const TraceSettings& trace,
                                  const LightSample& sample) const;

  private:
    /// A ray on its way: p where it starts, what part of its light reaches the pixel.
    struct Branch {
        dvec3 origin, p;
        double weight, distance;  ///< distance: path from the camera [m]
        int depth;
        int inside;  ///< object of whose glass it is within, -1 for air
    };
    std::optional<dvec3> follow(const Branch& branch, const TraceSettings& trace, const LightSample& sample) const;
    std::optional<Hit> meet(const Branch& branch, const TraceSettings& trace, dvec3& p, double& length,
                            bool& dark) const;
    double index(const dvec3& x) const { return field_ ? field_->speed(x) : 1; }

    const Geometry& geometry_;
    const Shading& shading_;
    const AirInstant* field_;
    const Shadowgraph* sunlight_;
    Cancelled cancelled_;
};

/// Part of unpolarised light that is reflected where it passes from index n1 to n2 at cosines cos1, cos2 to the normal
/// (Fresnel).
double fresnel_reflectance(double n1, double cos1, double n2, double cos2);

}  // namespace eikonal::reference
