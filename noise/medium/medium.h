/// A medium: one kind of hot air, built once a shot, as the warp, the tracer and `eikonal field` see it.
///
///     parameters (medium_spec.h)  --build-->  Medium  --at(t)-->  MediumInstant
///
/// A MediumInstant answers for one moment: the index and its derivatives at a point, how far a ray may step from there
/// without missing anything, and how far it may go before it meets the medium at all. That is enough for every program:
/// the tracer follows rays through it, and the warp integrates it along straight rays (first order) or bent ones. What
/// a kind knows better, as a closed-form bend, is an addition.
///
/// Conventions: metres, seconds, kelvin; world axes right-handed, y up; all double. "Index" is n - n_ambient without
/// [optics] exaggeration, unless the kind has an absolute index, which is then n - 1. "Step", "way" and "stride" are
/// lengths along a ray in metres, > 0, and may be infinite. Directions d are of unit length; p is dx/du.
/// Every result is finite for finite arguments, but for lengths. Both classes are immutable and thread-safe; the same
/// arguments give the same bits in any order and on any number of threads.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "noise/math/index_sample.h"
#include "noise/math/ray_bounds.h"
#include "noise/medium/field_slices.h"
#include "noise/medium/force_jet.h"
#include "noise/medium/force_law.h"
#include "noise/medium/ground_plane.h"
#include "noise/medium/optics.h"
#include "noise/medium/refractivity.h"
#include "noise/medium/shot_frame.h"

namespace eikonal {

/// What an instant is made for. Only `law` and `weight` change what a medium is; the rest says how closely it is looked
/// at.
struct InstantSettings {
    ForceLaw law;
    double weight = 1;  ///< multiplies the index, beside the exaggeration
    double step = 1;    ///< multiplies the longest steps; the smaller, the more exact
    /// Where a blob may be taken to end, in its sigmas; left out: where kNegligibleIndex of it is left.
    std::optional<double> reach{};

    /// What multiplies ∇(n - n_ambient) in the force where n is near 1.
    double strength() const { return weight * law.strength(); }
};

/// One moment of a medium.
class MediumInstant {
  public:
    virtual ~MediumInstant() = default;

    /// A medium that has an index answers sample() and jet(). One that has a force of its own instead, which may depend
    /// on the ray's direction, answers force() and force_jet().
    virtual bool has_index() const { return true; }
    virtual IndexSample sample(const dvec3& x) const;
    virtual IndexJet jet(const dvec3& x) const;
    /// F [1/m] with weight and strength of the settings; added to that of the summed index.
    virtual dvec3 force(const dvec3& x, const dvec3& p) const;
    virtual ForceJet force_jet(const dvec3& x, const dvec3& p) const;

    /// The longest step from x along d that misses nothing: a part of the smallest feature that may be met on it, plus
    /// the way to it.
    virtual double longest_step(const dvec3& x, const dvec3& d) const = 0;
    /// The same for a step whose direction is not known.
    virtual double longest_step(const dvec3& x) const { return longest_step(x, dvec3(0)); }
    /// The longest step of a method that controls its own error and evaluates the force no further apart than half of
    /// it, so that it notices all that turns a ray by `turn` [rad] > 0 or more.
    virtual double longest_stride(const dvec3& x, const dvec3& d, double turn) const;
    /// Length of the way from x along d before the medium is met; 0 inside it, infinite if it is never met.
    virtual double clear_way(const dvec3& x, const dvec3& d) const;
    /// Length of the way from x along d to the next place where the force jumps, at which steps must end; infinite if
    /// there is none.
    virtual double way_to_edge(const dvec3& x, const dvec3& d) const;

    /// ∫₀^D (D - w) F dw along the straight ray from x, D = distance > 0 [m], in closed form, added to `sum`. False,
    /// and `sum` untouched, if there is no such form: callers then integrate. Parts that turn a ray by less than `turn`
    /// [rad] may be left out. The index n in F = n∇n is the ambient's. *added*
    virtual bool add_bend(const dvec3& x, const dvec3& d, double distance, double turn, StraightBend& sum) const;

    /// How far interpolation inside the medium turns rays: rms of the bend after 1 m [m^-1/2], and the part of its
    /// strength that the medium has at x.
    struct InterpolationBend {
        double error = 0, strength = 1;
    };
    virtual InterpolationBend interpolation_bend(const dvec3& x) const;

    /// A box that shows what the medium is like: all of it if it is small, else some of its largest features.
    virtual Box shown_box() const;
};

/// What a shot's media may take together; each takes its part as it is built.
struct ShotBudget {
    std::uint64_t memory = std::numeric_limits<std::uint64_t>::max();  ///< left [bytes]
    double blobs = 0;                                                  ///< taken so far

    void take_memory(std::uint64_t bytes) { memory -= bytes < memory ? bytes : memory; }
};

/// What a medium is built for.
struct MediumSetting {
    std::string name;  ///< "medium.2", for messages
    OpticsSpec optics{};
    std::optional<ShotFrame> frame{};                             ///< needed by thin screens (std::logic_error without)
    double bend_error = std::numeric_limits<double>::infinity();  ///< allowed of interpolation: as InterpolationBend
    /// Whether rays will be followed through instants. If not, what only at() needs is neither made nor counted in the
    /// budget, and at() may throw std::logic_error.
    bool followed_by_rays = true;
    ShotBudget* budget = nullptr;  ///< never null when build() is called
};

/// Never made of parameters that are still (MediumSpec::why_still).
class Medium : public std::enable_shared_from_this<Medium> {
  public:
    virtual ~Medium() = default;

    /// The moment t [s]. FrameError beyond the kind's range of t. The instant may outlive the medium.
    virtual std::shared_ptr<const MediumInstant> at(double t, const InstantSettings& settings) const = 0;

    /// What it has been made into, for --verbose: "lattice 64 x 64 x 64 x 32".
    virtual std::string note() const = 0;
    /// Why it bends nothing after all, though its parameters did not show it; empty if it bends.
    virtual std::string why_still() const { return {}; }
    /// What the user of any program should know of it, one line without the medium's name; empty if nothing.
    virtual std::string warning() const { return {}; }
    /// Rms error of its force between the nodes of a lattice, relative to the rms force; 0 without a lattice.
    virtual double interpolation_error() const { return 0; }
    /// The ground that bounds it from below, if it has any: no camera may be beneath.
    virtual std::optional<GroundPlane> ground() const { return {}; }
    /// Greatest distance from a point to any part of it at any time, 0 if it has no bounds [m].
    virtual double farthest_part(const dvec3& from) const;
    /// Slices for `eikonal field`. By default kFieldSamples³ samples of shown_box().
    virtual FieldSlices slices(double t, const ForceLaw& law) const;
};

}  // namespace eikonal
