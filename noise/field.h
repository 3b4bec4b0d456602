/// The refractive index of a whole scene: the sum of its media, frozen at one time, as a tracer follows it.
///
/// Index at x: 1 + ambient() + exaggeration Σ (n_i - n_ambient). A profile medium gives the absolute index and stands
/// alone, with nothing exaggerated. Ray equation d²x/du² = F (PHYSICS 1):
///     physical:  F = n∇n,  |dx/du| = n       (*corrected*)
///     paper:     F = ½∇n,  |dx/du| = √n      (*paper*: its "n" is the index squared)
/// All double; positions in world metres. FieldInstant is immutable and thread-safe and must not outlive its Field.
///
/// Thin screens (form = "screens") are not a function of position: the bend of a slab is spread evenly over it
/// (noise/screen_layout.h) and taken at the point where the ray's tangent meets the screen,
///     F⊥ = √L ∇⊥ψ_m(x⊥ + (w_m - z) p⊥/p_z)/δ,   L = |p|/p_z,   near_m < z < far_m,
/// z the depth along the frame's axis, with no force along the axis: the same air that the warp bends rays by, *added*.
/// They have no index of their own: |dx/du|² = n² holds for every other medium only.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "noise/index_sample.h"
#include "noise/media.h"
#include "noise/screen_layout.h"

namespace eikonal {

/// Where thin screens stand: planes across `forward`, at distances from `origin`. right, up, forward: orthonormal.
struct ScreenFrame {
    dvec3 origin{0, 0, 0}, right{1, 0, 0}, up{0, 1, 0}, forward{0, 0, -1};
    ScreenView view;
};

/// F and how it changes with the ray's position and direction.
struct ForceJet {
    dvec3 force{0, 0, 0};
    glm::dmat3 by_position{0};   ///< ∂F_i/∂x_j at [j][i]
    glm::dmat3 by_direction{0};  ///< ∂F_i/∂p_j at [j][i]: thin screens only
};

/// n - n_ambient of a medium below this is nothing: what bounds are drawn by, in parts of its own largest.
inline constexpr double kNegligibleIndex = 1e-16;

class FieldInstant {
  public:
    /// F [1/m] at x for a ray whose dx/du is p.
    dvec3 force(const dvec3& x, const dvec3& p) const;
    ForceJet force_jet(const dvec3& x, const dvec3& p) const;

    /// n - 1 at x. At most -1 where a scene's exaggeration leaves no index: rays must end there.
    double refractivity(const dvec3& x) const;
    /// |dx/du| of a ray at x: n, or √n in the paper's convention; 0 where n <= 0.
    double speed(const dvec3& x) const;

    /// The longest step [m] from x, in any direction, that misses nothing: a part of the smallest feature that may be
    /// met on it (blob σ, inner scale or cell, dropoff, radius of a profile), plus the way to it. > 0, may be infinite.
    double longest_step(const dvec3& x) const;
    /// Length of the way from x along the unit direction d that lies outside the bounds of every medium, hence is
    /// straight: 0 inside one; infinity if none is ever met.
    double clear_way(const dvec3& x, const dvec3& d) const;
    /// Length of the way from x along the unit direction d to the next place where F jumps (a thin screen's end, the
    /// start of a falloff, the edge of a surface or of a profile): steps must end there to keep their order. Infinity
    /// if there is none.
    double way_to_edge(const dvec3& x, const dvec3& d) const;

    FieldInstant(FieldInstant&&) noexcept;
    ~FieldInstant();

  private:
    friend class Field;
    struct State;
    explicit FieldInstant(std::unique_ptr<State> state);
    std::unique_ptr<State> state_;
};

class Field {
  public:
    /// frame: needed for media of form "screens". memory_limit [bytes]: what all of them may take.
    /// UserError, naming "medium.N": a profile beside other media, what a medium's own header refuses.
    Field(const std::vector<MediumSpec>& media, const OpticsSpec& optics, const std::optional<ScreenFrame>& frame,
          std::uint64_t memory_limit);
    ~Field();
    Field(Field&&) noexcept;

    /// Every medium at time t [s], any finite.
    FieldInstant at(double t) const;

    /// Whether any medium can bend anything: false for an empty scene or one whose media have no strength.
    bool bends() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace eikonal
