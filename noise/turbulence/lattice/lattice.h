/// Turbulence on a periodic 4-D lattice: one Gaussian random spectrum of n - n_ambient over space and time, from which
/// come any instant (lattice_snapshot.h), exact displacement tables (path_tables.h), or the whole period at once.
///
///     n'(x, t) = Σ_k e^{ik·(x - vt)} [ a_k + Σ_{j=1..J} P_kj cos(κ_j t) + M_kj sin(κ_j t) ],   κ_j = 2πj/T
///
/// Normalisation (PHYSICS.md#turbulence). A spatial mode has the variance Φ(k) dk³, dk³ = Π 2π/L_i, at every instant
/// and for every α: the temporal weights exp(-κ²/(αk²)) are normalised over the lattice's κ (*corrected*). They are
/// stored as standing waves, P = a₊ + a₋ and M = i(a₊ - a₋), which is the same process as independent complex
/// amplitudes a± at ±κ_j, halves the work of an instant, and makes Hermitian symmetry a matter of each κ alone. With an
/// even nt the temporal Nyquist frequency keeps both halves ±κ, so that the variance is constant between the time
/// samples too. The k = 0 mode is zero: a lattice period has no mean deviation.
///
/// Nyquist modes of space (even sizes; at Nyquist along one axis or more) belong to n, whose variance counts them, but
/// bend no light: F̂ = ik n̂ is zero there along every axis. Their slope is known at the nodes only, where it vanishes,
/// and they cannot be moved by part of a cell: advection multiplies them by cos(k v t), so that n stays real. What is
/// left moves exactly at any sub-voxel shift, and is one function, without curl, on which the node values of F, the
/// tables, a ray through a snapshot and the tracer agree. LatticeField::bending_spectrum_at is its n.
///
/// Time. Any real t up to 1e9 s, at equal cost: κt and v t are reduced before the trigonometry. With v = 0 the field
/// repeats after T without a seam; with v it does if every v_i T is a whole number of periods L_i.
/// Sizes: nx, ny, nz >= 2 and nt >= 1, odd or even, any factors; nt = 1 is frozen, as is alpha = 0.
/// Units: metres, seconds, rad/m. Storage is single precision; temporal terms below kNegligibleWeight of their mode's
/// strongest are left out before normalising. Node (0, 0, 0) lies at the world's origin.
/// Same bits for any number of threads and any processor.
#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "noise/math/fft.h"
#include "noise/math/fourier_bins.h"
#include "noise/medium/media.h"
#include "noise/turbulence/parameters/spectrum.h"

namespace eikonal {

/// Temporal weights below this part of a mode's strongest are not stored.
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

/// What a spec asks for, and for what it leaves out: period 2 L0; cells of l0/2 (von Kármán), but at most
/// kLargestDefaultSize a side, and 32 for the paper's spectrum; T = 4 correlation times 2/(√α k0) of the largest
/// eddies, nt = 32 (1, frozen, for α = 0). Small eddies that T/nt cannot follow evolve at the lattice's own pace.
LatticeGeometry choose_lattice(const TurbulenceSpec& spec);
inline constexpr int kLargestDefaultSize = 128;

/// Bytes for the field, an instant of it with its spline, and its four node fields; saturates at 2^64 - 1.
std::uint64_t lattice_bytes(const TurbulenceSpec& spec, const LatticeGeometry& geometry);

/// UserError for a size below 2 (nt: 1), nz nt > 2e9, a period that is not positive and
/// finite, or more memory than memory_limit [bytes]; allocates nothing.
void check_lattice(const TurbulenceSpec& spec, const LatticeGeometry& geometry, std::uint64_t memory_limit);

/// A field that LatticeField can return: the index, or a component of its gradient [1/m].
enum class Component { Index, ForceX, ForceY, ForceZ };

/// The random spectrum of one medium. Immutable; every member is thread-safe. Falloff is not applied here.
class LatticeField {
  public:
    /// Draws every amplitude from spec.seed. Throws what check_lattice throws, but for the memory limit, and UserError
    /// for a strength beyond single precision, and for the paper's lowest wavenumber beyond all that bends light.
    LatticeField(const TurbulenceSpec& spec, const LatticeGeometry& geometry);

    /// Spatial spectrum of n - n_ambient at time t [s]: nx × ny × (nz/2 + 1), row-major, Hermitian in its planes
    /// kz = 0 and Nyquist, so that the unnormalised inverse transform gives the node values.
    FftVector<complex32> spectrum_at(double t) const;
    /// The same into an array of that size.
    void spectrum_at(double t, complex32* spectrum) const;
    /// The same without the Nyquist modes of space: the n whose gradient is the force.
    FftVector<complex32> bending_spectrum_at(double t) const;

    /// Every sample of the period, nt × nx × ny × nz row-major (z fastest), by one 4-D inverse FFT, at t = m T/nt.
    /// Without the mean motion, whose phase has no period in T. For several components keep a PeriodSynthesis.
    FftVector<float> synthesize_period(Component what) const;
    /// The 4-D half-complex spectrum of that, nt × nx × ny × (nz/2 + 1), every element written.
    void period_spectrum(Component what, complex32* spectrum) const;

    const LatticeGeometry& geometry() const { return geometry_; }
    const TurbulenceSpec& spec() const { return spec_; }

    /// Φ(k) dk³ of the mode with signed indices m: E|n̂_k|² at every instant; 0 for m = 0.
    double mode_variance(int mx, int my, int mz) const;
    /// Correlation in time of that mode's amplitude, without mean motion, on this lattice: exp(-αk²t²/4) where
    /// resolved.
    double mode_correlation(int mx, int my, int mz, double t) const;
    /// Discrete expectation <n'²>.
    double variance() const;
    /// Discrete expectation of the structure function D_n = <(n(x + r) - n(x))²> for r cells along an axis, r >= 0.
    double structure_function(int axis, double r) const;
    /// Discrete expectations of the variance [m²] of the two lateral components of x1(u), along the other two axes in
    /// ascending order, for rays along `axis` (0 … 2), path u [m] and an aperture of diameter `aperture` [m] (0:
    /// point); over realisations and starting points. Grows as u⁴ below the correlation length, as u³ beyond.
    /// (path_tables.cpp)
    std::array<double, 2> displacement_variance(int axis, double u, double aperture) const;
    /// Discrete expectations of the variance of the slope of the map along either lateral axis e (PHYSICS.md#focusing):
    /// ∂x1_e/∂x_e at u for parallel rays along `axis`, ∂(x1_e/u)/∂θ_e for rays that diverge from a point at angles θ_e
    /// to it, whose weight is then w(u - w)/u instead of u - w. The latter counts a point aperture, which bounds it.
    /// (lattice_statistics.cpp)
    std::array<double, 2> focusing_variance(int axis, double u, bool perspective, double aperture) const;

  private:
    /// One (kx, ky): its amplitudes are re[total] then im[total], each a over every z, then P and M of j = 1 … terms
    /// over z >= first_modes()[j].
    struct Row {
        std::size_t offset;  ///< of re in amplitudes_
        int terms;           ///< J of this row
        int total;
    };

    double wavenumber2(int mx, int my, int mz) const;
    /// First z whose mode holds frequency j in quadrant row (mx, my); half() if none.
    int first_mode(int mx, int my, int j) const;
    std::size_t row_index(int ix, int iy) const {
        return static_cast<std::size_t>(ix) * static_cast<std::size_t>(geometry_.size[1]) +
               static_cast<std::size_t>(iy);
    }
    /// first_ of the quadrant of bins (ix, iy); index j.
    const std::uint16_t* first_modes(int ix, int iy) const;
    /// Modes ±κ_j that term j stands for: 2, but 1 for the mean and for the two halves of Nyquist.
    double multiplicity(int j) const { return j == 0 || is_nyquist(j, geometry_.size[3]) ? 1 : 2; }
    void layout();
    void draw_quadrant(int mx, int my);

    TurbulenceSpec spec_;
    LatticeGeometry geometry_;
    Spectrum spectrum_;
    double cell_volume_;  ///< dk³
    int frequencies_;     ///< J = floor(nt/2), 0 if frozen
    std::vector<Row> rows_;
    std::vector<std::uint16_t> first_;  ///< [quadrant row][j]
    FftScratch<float> amplitudes_;
};

/// Plan and memory of the 4-D transform, for one component after another. Not for two threads at once.
class PeriodSynthesis {
  public:
    /// field must outlive this.
    explicit PeriodSynthesis(const LatticeField& field);
    /// As LatticeField::synthesize_period; valid until the next call.
    std::span<const float> operator()(Component what);

  private:
    const LatticeField& field_;
    FftPlan plan_;
    FftScratch<complex32> spectrum_;
    FftScratch<float> samples_;
};

}  // namespace eikonal
