/// Turbulence on a periodic 4-D lattice: one Gaussian random spectrum of n - n_ambient over space and time. It yields
/// any instant (lattice_instant.h), exact displacement tables (path_tables.h), or the whole period at once.
///
///     n'(x, t) = Σ_k e^{ik·(x - vt)} [ a_k + Σ_{j=1..J} P_kj cos(κ_j t) + M_kj sin(κ_j t) ],   κ_j = 2πj/T
///
/// Normalisation (PHYSICS.md#turbulence). A spatial mode has the variance Φ(k) dk³, dk³ = Π 2π/L_i, at every instant
/// and for every α: the temporal weights exp(-κ²/(αk²)) are normalised over the lattice's κ (*corrected*). The mode k =
/// 0 is zero, so a period of the lattice has no mean deviation.
///
/// Storage. Amplitudes are stored as standing waves, P = a₊ + a₋ and M = i(a₊ - a₋). This is the same process as
/// independent complex amplitudes a± at ±κ_j. It halves the work for an instant, and each κ has its own Hermitian
/// symmetry. With an even nt the temporal Nyquist frequency keeps both halves ±κ, so the variance is constant between
/// time samples too. Terms below kNegligibleWeight of their mode's strongest term are left out before the
/// normalisation. Storage is single precision.
///
/// Nyquist modes of space. A mode is Nyquist if it is so along at least one axis of even size. Such a mode belongs to
/// n, and the variance counts it, but it bends no light: F̂ = ik n̂ is zero for it along every axis. Its slope is known
/// at the nodes only, where it vanishes. A shift by part of a cell is not defined for it, so advection multiplies it by
/// cos(k v t), which keeps n real. All other modes move exactly at any shift. They make up one function without curl,
/// whose n is LatticeField::bending_spectrum_at. The node values of F, the tables, a ray through an instant and the
/// tracer agree on it.
///
/// Time. Any real |t| <= 1e9 s has the same cost: κt and v t are reduced before the trigonometry. With v = 0 the field
/// repeats after T without a seam. With a velocity it does so if every v_i T is a whole number of periods L_i.
///
/// Sizes: nx, ny, nz >= 2 and nt >= 1, odd or even, with any factors. nt = 1 is frozen, as is α = 0. Units: metres,
/// seconds, rad/m. Node (0, 0, 0) lies at the world's origin. The bits are the same for any number of threads and any
/// processor.
/// Theory: PHYSICS.md#lattice.
#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "noise/math/fft.h"
#include "noise/math/fourier_bins.h"
#include "noise/turbulence/parameters/spectrum.h"
#include "noise/turbulence/parameters/turbulence_spec.h"

namespace eikonal {

/// Temporal weights below this part of a mode's strongest weight are not stored.
inline constexpr double kNegligibleWeight = 1e-8;

/// Sizes and periods along x, y, z and t.
struct LatticeGeometry {
    std::array<int, 4> size{};       ///< nx, ny, nz >= 2; nt >= 1
    std::array<double, 4> period{};  ///< Lx, Ly, Lz [m], T [s] > 0

    /// Cell along a spatial axis or the time step [m or s].
    double spacing(int axis) const { return period[axis] / size[axis]; }
    /// Number of z modes kept of a real field: nz/2 + 1.
    int half() const { return size[2] / 2 + 1; }
    std::size_t spatial_samples() const;
    std::size_t half_spectrum() const;  ///< nx ny (nz/2 + 1)
};

/// The lattice that a spec asks for. What the spec leaves out has a default:
///     period    2 L0
///     size      cells of l0/2 for von Kármán, but at most kLargestDefaultSize a side; 32 for the paper's spectrum
///     T         4 correlation times 2/(√α k0) of the largest eddies
///     nt        32; 1 (frozen) for α = 0
/// Small eddies evolve faster than the time step T/nt can follow. They decorrelate from one time sample to the next.
LatticeGeometry choose_lattice(const TurbulenceSpec& spec);
inline constexpr int kLargestDefaultSize = 128;

/// Bytes for the field, one instant with its spline, and the four node fields. Saturates at 2^64 - 1.
std::uint64_t lattice_bytes(const TurbulenceSpec& spec, const LatticeGeometry& geometry);

/// Throws UserError for a size below 2 (nt: 1), for nz nt > 2e9, for a period that is not positive and finite, and for
/// more memory than memory_limit [bytes]. Allocates nothing.
void check_lattice(const TurbulenceSpec& spec, const LatticeGeometry& geometry, std::uint64_t memory_limit);

/// What a field of node values holds: the index, or a component of its gradient [1/m].
enum class Component { Index, ForceX, ForceY, ForceZ };

/// The random spectrum of one medium, without falloff. Immutable, thread-safe.
class LatticeField {
  public:
    /// Draws every amplitude from spec.seed. Throws what check_lattice throws, except for the memory limit. Throws
    /// UserError for a strength beyond single precision, and for a lowest wavenumber of the paper's spectrum beyond all
    /// modes that bend light.
    LatticeField(const TurbulenceSpec& spec, const LatticeGeometry& geometry);

    /// Spatial spectrum of n - n_ambient at time t [s]: nx × ny × (nz/2 + 1), row-major, Hermitian in its planes
    /// kz = 0 and Nyquist. Its unnormalised inverse transform is the node values.
    FftVector<complex32> spectrum_at(double t) const;
    /// The same, written into an array of that size.
    void spectrum_at(double t, complex32* spectrum) const;
    /// The same without the Nyquist modes of space. The gradient of this n is the force.
    FftVector<complex32> bending_spectrum_at(double t) const;

    /// Every sample of the period at t = m T/nt, nt × nx × ny × nz, row-major (z fastest), by one 4-D inverse FFT. The
    /// mean motion is left out, since it has no period T. For several components, keep a PeriodSynthesis.
    FftVector<float> synthesize_period(Component what) const;
    /// The 4-D half-complex spectrum of those samples, nt × nx × ny × (nz/2 + 1). Writes every element.
    void period_spectrum(Component what, complex32* spectrum) const;

    const LatticeGeometry& geometry() const { return geometry_; }
    const TurbulenceSpec& spec() const { return spec_; }

    /// Φ(k) dk³ of the mode with signed indices m, which is E|n̂_k|² at every instant. 0 for m = 0.
    double mode_variance(int mx, int my, int mz) const;
    /// Correlation in time of that mode's amplitude on this lattice, without mean motion. It is exp(-αk²t²/4) where the
    /// time step resolves it.
    double mode_correlation(int mx, int my, int mz, double t) const;
    /// Discrete expectation of <n'²>.
    double variance() const;
    /// Discrete expectation of the structure function D_n = <(n(x + r) - n(x))²> for r cells along an axis, r >= 0.
    double structure_function(int axis, double r) const;
    /// Discrete expectations of the variance [m²] of the two lateral components of x1(u), over realisations and
    /// starting points. The components are along the other two axes in ascending order. axis: of the rays, 0 … 2. u:
    /// path [m]. aperture: diameter [m], 0 for a point. The variance grows as u⁴ below the correlation length and as u³
    /// beyond. (path_tables.cpp)
    std::array<double, 2> displacement_variance(int axis, double u, double aperture) const;
    /// Discrete expectations of the variance of the map's slope along either lateral axis e (PHYSICS.md#focusing).
    /// Parallel rays along `axis`: the slope is ∂x1_e/∂x_e at u. Perspective: rays diverge from a point at angles θ_e
    /// to the axis, the slope is ∂(x1_e/u)/∂θ_e, and the weight w(u - w)/u takes the place of u - w. Perspective
    /// assumes a point aperture, which gives an upper bound. (lattice_statistics.cpp)
    std::array<double, 2> focusing_variance(int axis, double u, bool perspective, double aperture) const;

  private:
    /// The amplitudes of one (kx, ky): re[total], then im[total]. Each holds a for every z, then P and M of
    /// j = 1 … terms for z >= first_modes()[j].
    struct Row {
        std::size_t offset;  ///< of re in amplitudes_
        int terms;           ///< J of this row
        int total;
    };

    double wavenumber2(int mx, int my, int mz) const;
    /// The first z whose mode holds frequency j in the rows (±mx, ±my). half() if none does.
    int first_mode(int mx, int my, int j) const;
    std::size_t row_index(int ix, int iy) const {
        return static_cast<std::size_t>(ix) * static_cast<std::size_t>(geometry_.size[1]) +
               static_cast<std::size_t>(iy);
    }
    /// first_mode() of the row of bins (ix, iy), by j.
    const std::uint16_t* first_modes(int ix, int iy) const;
    /// How many frequencies ±κ_j term j stands for: 1 for the mean and for Nyquist, else 2.
    double multiplicity(int j) const { return j == 0 || is_nyquist(j, geometry_.size[3]) ? 1 : 2; }
    struct Quadrant;
    void layout();
    Quadrant quadrant(int mx, int my) const;
    void draw_quadrant(int mx, int my);

    TurbulenceSpec spec_;
    LatticeGeometry geometry_;
    Spectrum spectrum_;
    double cell_volume_;  ///< dk³
    int frequencies_;     ///< J = floor(nt/2), 0 if frozen
    std::vector<Row> rows_;
    std::vector<std::uint16_t> first_;  ///< first_mode() for [mx][my][j]
    FftScratch<float> amplitudes_;
};

/// Plan and memory of the 4-D transform, for one component after another. Not thread-safe.
class PeriodSynthesis {
  public:
    /// field must outlive this.
    explicit PeriodSynthesis(const LatticeField& field);
    /// As LatticeField::synthesize_period. The result is valid until the next call.
    std::span<const float> operator()(Component what);

  private:
    const LatticeField& field_;
    FftPlan plan_;
    FftScratch<complex32> spectrum_;
    FftScratch<float> samples_;
};

}  // namespace eikonal
