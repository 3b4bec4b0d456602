/// The paper's ray tree: the radiance along a bent ray, with the light that mirrors and glass send from elsewhere.
///
/// A surface reflects the part `mirror` of the light as a mirror, and the rest is matte (shading.h). A surface of glass
/// (`refractive_index`) reflects the part that Fresnel's equations give for unpolarised light. It refracts the rest by
/// Snell's law: |p| is the index, and the part of p along the surface is the same on both sides. Reflected and
/// refracted rays go on bent. There is no air within glass: rays are straight until they leave it through its own
/// surface.
///
/// A branch ends after kDeepestBranch surfaces, or when less than kFaintest of its light can reach the pixel. It is
/// then black. Rays without an end (BentHit::ended) are black too.
/// Theory: PHYSICS.md#tracer.
#pragma once

#include "reference/trace/bent_ray.h"
#include "reference/trace/shading.h"
#include "reference/trace/stop.h"

namespace eikonal::reference {

class Shadowgraph;

inline constexpr int kDeepestBranch = 12;
inline constexpr double kFaintest = 1e-3;

/// Immutable; its arguments must outlive it.
class RayTree {
  public:
    /// field: null for straight rays. sunlight: null for straight sunlight.
    RayTree(const Geometry& geometry, const Shading& shading, const AirInstant* field, const Shadowgraph* sunlight,
            const std::stop_token& stop)
        : geometry_(geometry), shading_(shading), field_(field), sunlight_(sunlight), stop_(stop) {}

    /// The radiance along one ray. direction: of any length. trace: settings of this ray and of all rays that follow;
    /// not used for straight rays. Nothing if the ray itself has no end. FrameError once a stop is requested; the
    /// token must outlive this.
    std::optional<dvec3> radiance(const dvec3& origin, const dvec3& direction, const TraceSettings& trace,
                                  const LightSample& sample) const;

  private:
    /// A ray of the tree: its start with p there, and the part of its light that reaches the pixel.
    struct Branch {
        dvec3 origin, p;
        double weight, distance;  ///< distance: length of path from the camera [m]
        int depth;
        int inside;  ///< the object whose glass the ray is in, -1 for air
    };
    std::optional<dvec3> follow(const Branch& branch, const TraceSettings& trace, const LightSample& sample) const;
    std::optional<Hit> meet(const Branch& branch, const TraceSettings& trace, dvec3& p, double& length,
                            bool& dark) const;
    double index(const dvec3& x) const { return field_ ? field_->speed(x) : 1; }

    const Geometry& geometry_;
    const Shading& shading_;
    const AirInstant* field_;
    const Shadowgraph* sunlight_;
    const std::stop_token& stop_;
};

/// The part of unpolarised light that is reflected where it passes from index n1 to index n2 (Fresnel). cos1, cos2:
/// cosines of the angles to the normal.
double fresnel_reflectance(double n1, double cos1, double n2, double cos2);

}  // namespace eikonal::reference
