/// Turbulent velocity without mean motion, in its own units: outer scale L0 = 1, rms of each component 1, hence
/// turnover L0/rms = 1. noise/blobs/wind.h gives it size, speed and place.
///
/// The velocity has no divergence and the von Kármán spectrum. Stam & Fiume 1993 make such a wind by the 4-D synthesis
/// of the index field (noise/turbulence/lattice/lattice.h). Here it is the curl of a random vector potential, *added*.
/// The potential's components are three independent lattice fields a_i of spectrum (k² + k0²)^(-11/6) e^(-k²/km²), each
/// mode divided by √(k² + k0²). Hence
///
///     <v_i v_j> ∝ (k² δ_ij - k_i k_j) (k² + k0²)^(-17/6) e^(-k²/km²),   k0 = 2π,
///     E(k) ∝ k⁴ (k² + k0²)^(-17/6) e^(-k²/km²)   → k^(-5/3) for k0 << k << km = 5.92/kEddyInnerScale
///
/// An instant keeps the potential as periodic cubic B-splines and takes their exact curl. Between the nodes the
/// velocity therefore has no divergence, except for rounding (kEddyDivergence), and it and its first derivatives are
/// continuous. The rms is exact: the spline's gain of each mode is part of it.
///
/// Evolution. A mode's correlation in time is exp(-αk²t²/4) with α = rms². An eddy lives for about as long as it turns:
/// the largest ones decorrelate to 1/e in L0/(π rms), and those of size l in l/L0 of that time. This is also the time
/// in which larger eddies would sweep them past. Eddies below a third of L0 are faster than kEddyTimes resolves, and
/// all evolve alike. The lattice repeats after kEddyLoop turnovers. It also drifts, by a quarter of the rms, so that
/// within kEddyLoopsApart loops no instant returns to within half an outer scale of where it was.
///
/// The bits are the same for any number of threads and any processor. Failures: std::bad_alloc.
/// Theory: PHYSICS.md#wind.
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
/// Drift of the lattice in one loop [periods]. A search found it: it gives the most loops apart.
inline constexpr std::array<double, 3> kEddyDrift{0.085213, 0.177322, 0.141928};
inline constexpr int kEddyLoopsApart = 140;
/// Largest divergence of the velocity, relative to the rms of its gradient: rounding of single precision.
inline constexpr double kEddyDivergence = 1e-4;

/// The eddies at one time. Immutable, thread-safe.
class EddyInstant {
  public:
    /// Velocity [rms] at any finite x [lattice periods]. Periodic with 1.
    dvec3 velocity(const dvec3& x) const;

  private:
    friend class EddyField;
    EddyInstant() = default;
    FftScratch<float> coefficients_;  ///< of the potential: three and a zero at each node, wrapped (eddies.cpp)
};

/// Memory to work in, for one thread at a time. Used again for many instants, it saves the cost of fresh memory.
struct EddyWorkspace {
    FftScratch<complex32> spectra;
    FftScratch<float> nodes;
};

/// The random potential of one wind. Immutable, thread-safe.
class EddyField {
  public:
    explicit EddyField(std::uint64_t seed);

    /// The eddies at any finite time t [turnovers], without the drift.
    EddyInstant at(double t, EddyWorkspace& room) const;
    EddyInstant at(double t) const {
        EddyWorkspace room;
        return at(t, room);
    }

  private:
    std::array<LatticeField, 3> potential_;
    FftPlan plan_;
    std::vector<float> filter_;  ///< factor of every mode: scale/√(k² + k0²), times the splines' prefilter
};

}  // namespace eikonal
