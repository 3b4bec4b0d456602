/// A medium: one kind of hot air, built once a shot. The warp, the tracer and `eikonal field` all use it.
///
///     parameters (medium_spec.h)  --build-->  Medium  --at(t)-->  MediumInstant
///
/// A MediumInstant is the medium at one moment. It gives the index and its derivatives at a point, the longest step of
/// a ray from there that misses nothing, and the distance to the medium from outside. This is enough for every program.
/// The tracer follows rays through it. The warp integrates it along straight rays (first order) or bent ones. A kind
/// may offer more, such as a closed form of the bend.
///
/// Conventions: metres, seconds, kelvin; world axes right-handed, y up; all double. "Index" is n - n_ambient without
/// [optics] exaggeration, unless the kind has an absolute index, which is then n - 1. "Step", "way" and "stride" are
/// lengths along a ray in metres, > 0, and may be infinite. Directions d are of unit length; p is dx/du. For finite
/// arguments every result is finite, except lengths. Both classes are immutable and thread-safe. The same arguments
/// give the same bits in any order and on any number of threads.
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

/// The circumstances of an instant. `law` and `weight` change the medium. The other settings only decide how exactly it
/// is followed.
struct InstantSettings {
    ForceLaw law;
    double weight = 1;  ///< factor on the index besides the exaggeration
    double step = 1;    ///< factor on the longest steps; a smaller one is more exact
    /// Distance from its centre at which a blob ends, in its sigmas. If left out, where kNegligibleIndex of it is left.
    std::optional<double> reach{};

    /// The factor on ∇(n - n_ambient) in the force where n is near 1.
    double strength() const { return weight * law.strength(); }
};

/// A medium at one moment.
class MediumInstant {
  public:
    virtual ~MediumInstant() = default;

    /// Whether the medium has an index, which sample() and jet() then give. Otherwise it has a force of its own, which
    /// may depend on the ray's direction, and which force() and force_jet() give.
    virtual bool has_index() const { return true; }
    virtual IndexSample sample(const dvec3& x) const;
    virtual IndexJet jet(const dvec3& x) const;
    /// F [1/m], with the weight and strength of the settings. It is added to the force of the summed index.
    virtual dvec3 force(const dvec3& x, const dvec3& p) const;
    virtual ForceJet force_jet(const dvec3& x, const dvec3& p) const;

    /// The longest step from x along d that misses nothing. It is a part of the smallest feature that the step may
    /// reach, plus the distance to that feature.
    virtual double longest_step(const dvec3& x, const dvec3& d) const = 0;
    /// The same for a step in an unknown direction.
    virtual double longest_step(const dvec3& x) const { return longest_step(x, dvec3(0)); }
    /// The longest step of a method that controls its own error and evaluates the force at intervals of at most half
    /// the step. The step is short enough to notice everything that turns a ray by `turn` [rad] > 0 or more.
    virtual double longest_stride(const dvec3& x, const dvec3& d, double turn) const;
    /// Distance from x along d to the medium; 0 inside it, infinite if the ray does not reach it.
    virtual double clear_way(const dvec3& x, const dvec3& d) const;
    /// Distance from x along d to the next place where the force jumps, at which steps must end; infinite if there is
    /// none.
    virtual double way_to_edge(const dvec3& x, const dvec3& d) const;

    /// Adds ∫₀^D (D - w) F dw along the straight ray from x, D = distance > 0 [m], to `sum`, in closed form. If there
    /// is no closed form, returns false and leaves `sum` unchanged; the caller then integrates. Parts that turn a ray
    /// by less than `turn` [rad] may be left out. The index n in F = n∇n is the ambient's. *added*
    virtual bool add_bend(const dvec3& x, const dvec3& d, double distance, double turn, StraightBend& sum) const;

    /// The error of a ray's direction by interpolation inside the medium: its rms after 1 m [m^-1/2], and the part of
    /// its full strength that the medium has at x.
    struct InterpolationBend {
        double error = 0, strength = 1;
    };
    virtual InterpolationBend interpolation_bend(const dvec3& x) const;

    /// A box that shows the structure of the medium: all of it if it is small, else some of its largest features.
    virtual Box shown_box() const;
};

/// What all media of a shot may use together. Each medium takes its part when it is built.
struct ShotBudget {
    std::uint64_t memory = std::numeric_limits<std::uint64_t>::max();  ///< memory that is left [bytes]
    double blobs = 0;                                                  ///< number of blobs so far

    void take_memory(std::uint64_t bytes) { memory -= bytes < memory ? bytes : memory; }
};

/// The circumstances that a medium is built for.
struct MediumSetting {
    std::string name;  ///< "medium.2", for messages
    OpticsSpec optics{};
    std::optional<ShotFrame> frame{};                             ///< needed by thin screens (std::logic_error without)
    double bend_error = std::numeric_limits<double>::infinity();  ///< allowed error by interpolation: InterpolationBend
    /// Whether a lattice makes the splines that its at() needs. Without them at() of a lattice throws std::logic_error;
    /// the warp makes its own. Other kinds ignore this.
    bool lattice_splines = true;
    ShotBudget* budget = nullptr;  ///< not null when build() is called
};

/// A medium of a shot. It is never built from parameters that bend no light (MediumSpec::why_still).
class Medium : public std::enable_shared_from_this<Medium> {
  public:
    virtual ~Medium() = default;

    /// The medium at t [s]. FrameError beyond the kind's range of t. The instant may outlive the medium.
    virtual std::shared_ptr<const MediumInstant> at(double t, const InstantSettings& settings) const = 0;

    /// A note for --verbose on what it has been built as: "lattice 64 x 64 x 64 x 32".
    virtual std::string note() const = 0;
    /// The reason why it bends no light, if that was not to be seen from its parameters; empty if it bends light.
    virtual std::string why_still() const { return {}; }
    /// What the user of any program should know of it, in one line without the medium's name; else empty.
    virtual std::string warning() const { return {}; }
    /// Rms error of its force by interpolation between nodes, relative to the rms force; 0 without a lattice.
    virtual double interpolation_error() const { return 0; }
    /// The ground that bounds it from below, if any. No camera may be below the ground.
    virtual std::optional<GroundPlane> ground() const { return {}; }
    /// Largest distance from a point to any part of it at any time [m]; 0 if it has no bounds.
    virtual double farthest_part(const dvec3& from) const;
    /// Slices for `eikonal field`. By default kFieldSamples³ samples of shown_box().
    virtual FieldSlices slices(double t, const ForceLaw& law) const;
};

}  // namespace eikonal
