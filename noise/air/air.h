/// The refractive index of a whole scene: the sum of its media, frozen at one time, as a tracer follows it.
///
/// Index at x: n_ambient + exaggeration Σ (n_i - n_ambient), the ambient's that of IndexLaw
/// (noise/medium/refractivity.h). A profile medium gives the absolute index and stands alone, with nothing exaggerated.
/// Ray equation d²x/du² = F (PHYSICS.md#ray-equation):
///     physical:  F = n∇n,  |dx/du| = n       (*corrected*)
///     paper:     F = ½∇n,  |dx/du| = √n      (*paper*: its "n" is the index squared)
/// All double; positions in world metres. AirInstant is immutable and thread-safe, and may outlive its Field.
///
/// Thin screens (form = "screens") are not a function of position: the bend of a slab is spread evenly over it
/// (noise/turbulence/screens/screen_layout.h) and taken at the point where the ray's tangent meets the screen,
///     F⊥ = M ∇⊥ψ_m(x⊥ + (w_m - z) s)/(√L δ),   s = p⊥/p_z,   L = |p|/p_z,
///     M = 1 + s sᵀ/(L + 1),   near_m < z < far_m,
/// z the depth along the frame's axis, with no force along the axis: the same air that the warp bends rays by, *added*
/// (noise/turbulence/screens/screen_force.h). They have no index of their own: |dx/du|² = n² holds for every other
/// medium only.
///
/// Lattices are cubic splines through their trigonometric sum at the exact time, so F has continuous derivatives; what
/// it is off the sum's F by is at most kInterpolationError, and bends rays by no more than the field's user asks, up to
/// kFinestPadding and 640³ nodes (AirInstant::interpolation). Media of no strength are left out. Where n <= 0
/// there is no force but the screens'.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "noise/blobs/blob_instant.h"
#include "noise/math/index_sample.h"
#include "noise/medium/force_jet.h"
#include "noise/medium/media.h"
#include "noise/medium/shot_frame.h"
#include "noise/surface/surface.h"
#include "noise/turbulence/gradient_noise/gradient_noise.h"
#include "noise/turbulence/lattice/lattice_instant.h"
#include "noise/turbulence/screens/screens.h"

namespace eikonal {

/// Rms error of a lattice's F between its nodes, relative to the rms F, that its splines are padded for, and the most
/// that they are.
inline constexpr double kInterpolationError = 1e-3;
inline constexpr int kFinestPadding = 8;

/// Media that are frozen already, for a field put together of them. What is pointed to must outlive the field.
struct LatticePart {
    const LatticeField* field;
    std::shared_ptr<const LatticeInstant> snapshot;
    double bend_error = 0;  ///< SplineError::bend, if that is to be known
};
struct NoisePart {
    const GradientNoiseField* field;
    double t;  ///< [s]
};
struct ScreensPart {
    const ScreenField* field;
    std::vector<ScreenInstant> screens;  ///< of that field
    ShotFrame frame;
    std::optional<Falloff> falloff;
};
struct SurfacePart {
    const SurfaceIndex* layer;
    double step = 1;  ///< multiplies the longest steps over it, the smaller the more exact
};
struct BlobsPart {
    std::vector<Blob> blobs;
    double reach = kBlobReach;  ///< where they end [σ]
    double step = 1;            ///< multiplies the longest steps among them
};
struct FieldPart {
    std::variant<LatticePart, NoisePart, ScreensPart, SurfacePart, BlobsPart> medium;
    double weight = 1;  ///< multiplies n - n_ambient, beside the exaggeration
};

class AirInstant {
  public:
    AirInstant(const OpticsSpec& optics, std::vector<FieldPart> parts);

    /// F [1/m] at x for a ray whose dx/du is p.
    dvec3 force(const dvec3& x, const dvec3& p) const;
    ForceJet force_jet(const dvec3& x, const dvec3& p) const;
    /// F and |dx/du| in one, for half the price.
    struct Motion {
        dvec3 force;
        double speed;
    };
    Motion motion(const dvec3& x, const dvec3& p) const;

    /// n - 1 at x. At most -1 where a scene's exaggeration leaves no index: rays must end there.
    double refractivity(const dvec3& x) const;
    /// |dx/du| of a ray at x: n, or √n in the paper's convention; 0 where n <= 0.
    double speed(const dvec3& x) const;

    /// The longest step [m] from x, in any direction, that misses nothing: a part of the smallest feature that may be
    /// met on it (blob σ, inner scale or cell, dropoff, radius of a profile), plus the way to it. > 0, may be infinite.
    double longest_step(const dvec3& x) const;
    /// The same along the unit direction d of a ray: much longer over a surface, along which little changes. (Bending
    /// by other media is taken for small within a step, which their own features bound.)
    double longest_step(const dvec3& x, const dvec3& d) const;
    /// The longest step [m] from x along the unit direction d of a method that controls its error and evaluates F no
    /// further apart than half of it: it notices all that turns a ray by `turn` [rad] > 0 or more.
    double longest_stride(const dvec3& x, const dvec3& d, double turn) const;
    /// ∫₀^D (D - w) F dw along the straight ray from x, unit direction d, D = distance > 0 [m], in closed form, where
    /// blobs and thin screens are all there is (*added*). Blobs that turn a ray by less than `turn` [rad] are left out,
    /// and the n of F = n∇n is the ambient's.
    struct Pull {
        dvec3 value{0, 0, 0};  ///< [m]
        double error = 0;      ///< relative: of the second order, bound of |n - n_ambient| on the way
    };
    std::optional<Pull> pull(const dvec3& x, const dvec3& d, double distance, double turn) const;
    /// Length of the way from x along the unit direction d that lies outside the bounds of every medium, hence is
    /// straight: 0 inside one; infinity if none is ever met. A lattice or gradient noise has no bounds but those of a
    /// falloff, which ends at g = kNegligibleIndex upward and nowhere downward.
    double clear_way(const dvec3& x, const dvec3& d) const;
    /// Length of the way from x along the unit direction d to the next place where F jumps (a thin screen's end, the
    /// start of a falloff, the edge of a surface or of a profile): steps must end there to keep their order. Infinity
    /// if there is none; > 0, however small, if x is short of it by rounding. To keep a step's last stages on this
    /// side, end it a hair before the edge (1e-9 of the way) and cross two hairs straight.
    double way_to_edge(const dvec3& x, const dvec3& d) const;

    /// Expected rms of what interpolation in lattices moves a ray's end by, across the ray, and turns it by there.
    struct Interpolation {
        double shift = 0;  ///< [m]
        double turn = 0;   ///< [rad]
    };
    /// For a ray between two points that is about straight. *added*
    Interpolation interpolation(const dvec3& from, const dvec3& to) const;

    AirInstant(AirInstant&&) noexcept;
    AirInstant& operator=(AirInstant&&) noexcept;
    ~AirInstant();

  private:
    friend class Air;
    struct State;
    explicit AirInstant(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

class Air {
  public:
    /// frame: needed for media of form "screens" (std::logic_error without). memory_limit [bytes]: what all of them may
    /// take, one instant included. bend_error: what interpolation in a lattice may turn rays by after 1 m of them, rms
    /// [m^-1/2] > 0; it grows as the root of their way.
    /// UserError, naming "medium.N": a profile beside other media, what a medium's own header refuses.
    Air(const std::vector<MediumSpec>& media, const OpticsSpec& optics, const std::optional<ShotFrame>& frame,
        std::uint64_t memory_limit, double bend_error = std::numeric_limits<double>::infinity());
    ~Air();
    Air(Air&&) noexcept;

    /// Every medium at time t [s], any finite.
    AirInstant at(double t) const;

    /// One line a medium, "medium.N: …": what it has been made into, or why it is left out.
    const std::vector<std::string>& notes() const;

    /// Whether any medium can bend anything: false for an empty scene or one whose media have no strength.
    bool bends() const;

    /// Expected rms error of F by interpolation in the worst lattice, relative to its rms F; 0 without lattices.
    double interpolation_error() const;

  private:
    struct State;
    std::shared_ptr<State> state_;
};

}  // namespace eikonal
