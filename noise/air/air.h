/// The air of a scene: all its media, built once a shot, and their sum at one moment as rays follow it.
///
/// The index at x is n_ambient + exaggeration Σ (n_i - n_ambient). IndexLaw gives n_ambient
/// (noise/medium/refractivity.h). A medium with an absolute index stands alone, and nothing of it is exaggerated.
/// The ray equation d²x/du² = F follows from the index by ForceLaw (noise/medium/force_law.h, PHYSICS.md#ray-equation).
/// Media that have a force of their own, as thin screens do, add it. |dx/du|² = n² holds for all other media only.
///
/// All numbers are double, positions are in world metres. The force is continuous, except at the places that
/// way_to_edge() tells. Media without strength are left out. Where n <= 0, only media without an index have a force.
/// AirInstant is immutable and thread-safe, and may outlive its Air.
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

/// A medium's moment in a sum.
struct AirPart {
    std::shared_ptr<const MediumInstant> instant;
    double weight = 1;  ///< multiplies n - n_ambient beside the exaggeration; as in the instant's own settings
};

class AirInstant {
  public:
    AirInstant(const OpticsSpec& optics, std::vector<AirPart> parts);
    AirInstant(const ForceLaw& law, std::vector<AirPart> parts);

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

    // Lengths along a ray [m]: the least of what every medium says (MediumInstant).
    double longest_step(const dvec3& x) const;
    double longest_step(const dvec3& x, const dvec3& d) const;
    double longest_stride(const dvec3& x, const dvec3& d, double turn) const;
    double clear_way(const dvec3& x, const dvec3& d) const;
    /// Steps must end at an edge to keep their order. To keep a step's last stages on this side, end it a hair before
    /// the edge (1e-9 of the way) and cross two hairs straight.
    double way_to_edge(const dvec3& x, const dvec3& d) const;

    /// ∫₀^D (D - w) F dw along the straight ray from x, unit direction d, D = distance > 0 [m], where every medium
    /// knows it in closed form and first order holds; nothing elsewhere. *added*
    std::optional<StraightBend> straight_bend(const dvec3& x, const dvec3& d, double distance, double turn) const;

    /// Expected rms of what interpolation in lattices moves a ray's end by, across the ray, and turns it by there.
    struct Interpolation {
        double shift = 0;  ///< [m]
        double turn = 0;   ///< [rad]
    };
    /// For a ray between two points that is about straight. *added*
    Interpolation interpolation(const dvec3& from, const dvec3& to) const;

  private:
    template <class Jet, class Take>
    Jet sum(Take&& take) const;
    IndexSample sample(const dvec3& x) const;
    IndexJet jet(const dvec3& x) const;
    template <class Ask>
    double least(Ask&& ask) const;

    ForceLaw law_;
    std::vector<AirPart> indexed_, forced_;  ///< media with an index, and those with a force of their own
};

/// What an Air is built for.
struct AirSettings {
    std::optional<ShotFrame> frame{};  ///< needed by thin screens (std::logic_error without)
    std::uint64_t memory_limit = std::numeric_limits<std::uint64_t>::max();  ///< of all media, one instant included
    /// What interpolation in a lattice may turn rays by after 1 m of them, rms [m^-1/2] > 0; it grows as the root of
    /// their way.
    double bend_error = std::numeric_limits<double>::infinity();
    bool followed_by_rays = true;  ///< as in MediumSetting; at() needs it
};

class Air {
  public:
    /// UserError, naming "medium.N": a medium of absolute index beside others, what a kind refuses.
    Air(const std::vector<MediumSpec>& media, const OpticsSpec& optics, const AirSettings& settings = {});

    /// Every medium at time t [s], any finite.
    AirInstant at(double t) const;

    /// A medium that bends light, and its place in the scene.
    struct Part {
        std::size_t index;
        std::shared_ptr<const Medium> medium;
    };
    const std::vector<Part>& media() const { return media_; }
    const ForceLaw& law() const { return law_; }

    /// Of every medium of the scene: what it has been made into, or "left out, " and why.
    const std::vector<std::string>& medium_notes() const { return notes_; }
    /// The same as lines "medium.N: …".
    std::vector<std::string> notes() const;
    /// Lines "medium.N: …" on what the user should know.
    std::vector<std::string> warnings() const;
    /// Whether any medium can bend anything: false for an empty scene or one whose media have no strength.
    bool bends() const { return !media_.empty(); }
    /// Expected rms error of F by interpolation in the worst lattice, relative to its rms F; 0 without lattices.
    double interpolation_error() const;
    /// Greatest distance from a point to any part of a bounded medium at any time [m].
    double farthest_part(const dvec3& from) const;

  private:
    ForceLaw law_;
    std::vector<Part> media_;
    std::vector<std::string> notes_;
};

}  // namespace eikonal
