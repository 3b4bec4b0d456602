/// The air of a scene: all its media, built once a shot, and their sum at one instant, through which rays are followed.
///
/// The index at x is n_ambient + exaggeration Σ (n_i - n_ambient). IndexLaw gives n_ambient
/// (noise/medium/refractivity.h). A medium with an absolute index stands alone, and nothing of it is exaggerated.
/// The ray equation d²x/du² = F follows from the index by ForceLaw (noise/medium/force_law.h, PHYSICS.md#ray-equation).
/// Some media, such as thin screens, have a force of their own instead of an index. Their force is added. |dx/du|² = n²
/// holds only if there are no such media.
///
/// All numbers are double, positions are in world metres. The force is continuous, except at the places that
/// way_to_edge() finds. Media without strength are left out. Where n <= 0, only the media without an index have a
/// force. AirInstant is immutable and thread-safe, and may outlive its Air.
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "noise/medium/medium_spec.h"
#include "noise/medium/optics.h"

namespace eikonal {

/// One medium at an instant, as a term of the sum.
struct AirPart {
    std::shared_ptr<const MediumInstant> instant;
    double weight = 1;  ///< factor on n - n_ambient besides the exaggeration; the same as in the instant's settings
};

class AirInstant {
  public:
    AirInstant(const OpticsSpec& optics, std::vector<AirPart> parts);
    AirInstant(const ForceLaw& law, std::vector<AirPart> parts);

    /// F [1/m] at x for a ray whose dx/du is p.
    dvec3 force(const dvec3& x, const dvec3& p) const;
    ForceJet force_jet(const dvec3& x, const dvec3& p) const;
    /// F and |dx/du| together, at half the cost of two calls.
    struct Motion {
        dvec3 force;
        double speed;
    };
    Motion motion(const dvec3& x, const dvec3& p) const;

    /// n - 1 at x. It is -1 or less where the exaggeration makes n <= 0; rays must end there.
    double refractivity(const dvec3& x) const;
    /// |dx/du| of a ray at x: n, or √n in the paper's convention; 0 where n <= 0.
    double speed(const dvec3& x) const;

    // Lengths along a ray [m]. Each is the least of those of all media (MediumInstant).
    double longest_step(const dvec3& x) const;
    double longest_step(const dvec3& x, const dvec3& d) const;
    double longest_stride(const dvec3& x, const dvec3& d, double turn) const;
    double clear_way(const dvec3& x, const dvec3& d) const;
    /// Steps must end at an edge to keep their order. The last stages of a step must not lie behind the edge. A step
    /// should therefore end a little before it (1e-9 of the path) and cross twice that length straight.
    double way_to_edge(const dvec3& x, const dvec3& d) const;

    /// ∫₀^D (D - w) F dw along the straight ray from x, unit direction d, D = distance > 0 [m]. Nothing unless every
    /// medium has a closed form for it and the first order is a good approximation. *added*
    std::optional<StraightBend> straight_bend(const dvec3& x, const dvec3& d, double distance, double turn) const;

    /// Expected rms error at a ray's end that is caused by interpolation in lattices: across the ray, and of its
    /// direction.
    struct Interpolation {
        double shift = 0;  ///< [m]
        double turn = 0;   ///< [rad]
    };
    /// For a nearly straight ray between two points. *added*
    Interpolation interpolation(const dvec3& from, const dvec3& to) const;

  private:
    template <class Jet, class Take>
    Jet sum(Take&& take) const;
    IndexSample sample(const dvec3& x) const;
    IndexJet jet(const dvec3& x) const;
    template <class Ask>
    double least(Ask&& ask) const;

    ForceLaw law_;
    std::vector<AirPart> indexed_, forced_;  ///< media with an index; media with a force of their own
};

/// The circumstances that an Air is built for.
struct AirSettings {
    std::optional<ShotFrame> frame{};  ///< needed by thin screens (std::logic_error without)
    std::uint64_t memory_limit = std::numeric_limits<std::uint64_t>::max();  ///< [bytes] for all media and one instant
    /// Allowed rms change of a ray's direction by interpolation in a lattice after 1 m [m^-1/2] > 0. The change grows
    /// as the root of the length.
    double bend_error = std::numeric_limits<double>::infinity();
    bool lattice_splines = true;  ///< as in MediumSetting; at() of an air with lattices needs them
};

class Air {
  public:
    /// UserError that names "medium.N": a medium of absolute index beside others, or what a kind refuses.
    Air(const std::vector<MediumSpec>& media, const OpticsSpec& optics, const AirSettings& settings = {});

    /// The sum of all media at time t [s], any finite.
    AirInstant at(double t) const;

    /// A medium that bends light, and its place in the scene.
    struct Part {
        std::size_t index;
        std::shared_ptr<const Medium> medium;
    };
    const std::vector<Part>& media() const { return media_; }
    const ForceLaw& law() const { return law_; }

    /// One note for every medium of the scene: what it has been built as, or "left out, " and the reason.
    const std::vector<std::string>& medium_notes() const { return notes_; }
    /// The same notes as lines "medium.N: …".
    std::vector<std::string> notes() const;
    /// What the user should know, as lines "medium.N: …".
    std::vector<std::string> warnings() const;
    /// Whether any medium bends light. False for an empty scene, and if no medium has any strength.
    bool bends() const { return !media_.empty(); }
    /// Expected rms error of F by interpolation, relative to the rms of F, in the lattice where it is largest; 0
    /// without lattices.
    double interpolation_error() const;
    /// Largest distance from a point to any part of a bounded medium at any time [m].
    double farthest_part(const dvec3& from) const;

  private:
    ForceLaw law_;
    std::vector<Part> media_;
    std::vector<std::string> notes_;
};

}  // namespace eikonal
