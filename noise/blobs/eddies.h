/// Turbulent velocity without mean motion, in its own units: outer scale L0 = 1, rms of each component 1, hence
/// turnover L0/rms = 1. noise/blobs/wind.h gives it size, speed and place.
///
/// Divergence-free velocity with the von Kármán spectrum (Stam & Fiume 1993, by the 4-D synthesis of the index field,
/// noise/turbulence/lattice/lattice.h) as the curl of a random vector potential, *added*. Three independent lattice
/// fields a_i of spectrum (k² + k0²)^(-11/6) e^(-k²/km²), each mode divided by √(k² + k0²), are the potential's
/// components; so
///
///     <v_i v_j> ∝ (k² δ_ij - k_i k_j) (k² + k0²)^(-17/6) e^(-k²/km²),   k0 = 2π,
///     E(k) ∝ k⁴ (k² + k0²)^(-17/6) e^(-k²/km²)   → k^(-5/3) for k0 << k << km = 5.92/kEddyInnerScale
///
/// An instant keeps the potential as periodic cubic B-splines and takes their exact curl: the divergence of the
/// velocity between the nodes is zero but for rounding (kEddyDivergence), and it is continuous with its first
/// derivatives. The rms is that of this very interpolant, by the spline's own gain for each mode, hence exact.
///
/// Evolution: a mode's correlation in time is exp(-αk²t²/4) with α = rms²: an eddy lives for about as long as it turns,
/// the largest e-fold in L0/(π rms), those of size l in l/L0 of that, which is also the pace at which larger ones would
/// sweep them past; below a third of L0, faster than kEddyTimes resolves, all evolve alike. The lattice repeats after
/// kEddyLoop turnovers, but meanwhile it drifts (a quarter of the rms), so that within kEddyLoopsApart loops no instant
/// comes back to nearer than half an outer scale of where it was. Same bits for any number of threads and any
/// processor.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "noise/turbulence/lattice/lattice.h"

namespace eikonal {

inline constexpr int kEddySize = 20;                                    ///< lattice nodes along x, y and z
inline constexpr double kEddyPeriod = 2.5;                              ///< side of the lattice [L0]
inline constexpr double kEddyInnerScale = 3 * kEddyPeriod / kEddySize;  ///< l0 [L0]
inline constexpr int kEddyTimes = 12;                                   ///< time samples of a loop
inline constexpr double kEddyLoop = 2.5;                                ///< [turnovers]
/// Drift of the lattice a loop, in periods; found by search for the most loops apart.
inline constexpr std::array<double, 3> kEddyDrift{0.085213, 0.177322, 0.141928};
inline constexpr int kEddyLoopsApart = 140;
/// Largest divergence of the velocity, relative to the rms of its gradient: rounding of single precision.
inline constexpr double kEddyDivergence = 1e-4;

/// The eddies at one time. Immutable, thread-safe.
class EddyInstant {
  public:
    /// Velocity [rms] at x [lattice periods], any finite: periodic with 1.
    dvec3 velocity(const dvec3& x) const;

  private:
    friend class EddyField;
    EddyInstant() = default;
    FftScratch<float> coefficients_;  ///< of the potential, three and a zero a node, wrapped (eddies.cpp)
};

/// Room to work in, for one thread at a time; many instants in the same room save the pages of fresh memory.
struct EddyWorkspace {
    FftScratch<complex32> spectra;
    FftScratch<float> nodes;
};

/// Random potential of one wind. Immutable; thread-safe.
class EddyField {
  public:
    explicit EddyField(std::uint64_t seed);

    /// At time t [turnovers], any finite, without the drift.
    EddyInstant at(double t, EddyWorkspace& room) const;
    EddyInstant at(double t) const {
        EddyWorkspace room;
        return at(t, room);
    }

  private:
    std::array<LatticeField, 3> potential_;
    FftPlan plan_;
    std::vector<float> filter_;  ///< of every mode: scale/√(k² + k0²), and the splines' prefilter
};

}  // namespace eikonal
