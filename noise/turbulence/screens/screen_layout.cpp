#include "noise/turbulence/screens/screen_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "noise/base/error.h"
#include "noise/math/portable_math.h"
#include "noise/turbulence/parameters/turbulence_spec.h"

namespace eikonal {
namespace {

constexpr int kSmallestSide = 16, kLargestGivenSide = 32768, kMostGivenScreens = 4096, kMostSamples = 1 << 22;
constexpr double kPeriodInOuterScales = 4;  ///< coarser lattices are added until the period reaches this

int checked_count(const char* what, int value, int lowest, int highest) {
    if (value < lowest || value > highest)
        throw UserError(
            fmt::format("turbulence: lattice: {} is {}; screens allow {} to {}", what, value, lowest, highest));
    return value;
}

double checked_period(const char* what, double value) {
    if (!(value > 0) || !std::isfinite(value))
        throw UserError(fmt::format("turbulence: period: {} is {}; give a positive number", what, value));
    return value;
}

/// Far ends of `count` slabs. Each is as thick as L0 or the part q of its far end's distance, whichever is more.
std::vector<double> slab_ends(double L0, double q, int count) {
    std::vector<double> ends;
    double end = 0;
    for (int m = 0; m < count; ++m) ends.push_back(end = std::max(end + L0, end / (1 - q)));
    return ends;
}

/// Far ends of all slabs. The last one is `far`.
std::vector<double> layout_slabs(const TurbulenceSpec& spec, double far) {
    const double L0 = spec.outer_scale;
    const double most = std::max(1.0, std::floor(far / L0 * (1 + 1e-9)));
    int count = 1;
    if (spec.lattice) {
        count = checked_count("the number of screens (third)", (*spec.lattice)[2], 1, kMostGivenScreens);
        if (count > most)
            throw UserError(fmt::format(
                "turbulence: lattice: {} screens over {:g} m stand closer than the outer scale {:g} m and would "
                "not be independent; at most {:g} here, or reduce outer_scale",
                count, far, L0, most));
    } else {
        const double allowed = std::min(most, static_cast<double>(kMostScreens));
        while (count < allowed && slab_ends(L0, kSlabGrowth, count).back() < far) ++count;
    }
    // Bisection for the growth at which `count` slabs end at `far`. All ends are then scaled by what is left of the
    // error.
    double low = 0, high = 1;
    for (int i = 0; i < 60; ++i) {
        const double q = 0.5 * (low + high);
        (slab_ends(L0, q, count).back() < far ? low : high) = q;
    }
    std::vector<double> ends = slab_ends(L0, low, count);
    const double scale = far / ends.back();
    for (double& end : ends) end *= scale;
    ends.back() = far;
    return ends;
}

/// The loop within which eddies of the outer scale decorrelate eight times. Each decorrelation takes 2/(√α k0).
double default_loop(const TurbulenceSpec& spec, double fps) {
    const double k0 = portable::kTwoPi / spec.outer_scale;
    const double decorrelation = spec.alpha > 0 ? 2 / (std::sqrt(spec.alpha) * k0) : 0;
    return std::ceil(std::clamp(8 * decorrelation, 10.0, kLongestLoop) * fps) / fps;
}

struct Side {
    int n;
    double period;
};

Side side(const TurbulenceSpec& spec, int axis, double width, double cell) {
    const char* const name = axis == 0 ? "x" : "y";
    const double wanted = spec.spectrum == SpectrumKind::VonKarman
                              ? std::max(kFewestCells * cell, width)
                              : std::max(kPeriodInOuterScales * spec.outer_scale, width);
    const auto n_for = [&](double period) {
        // Transforms of a multiple of four are cheaper.
        const double cells =
            std::clamp(std::ceil(period / cell), static_cast<double>(kSmallestSide), static_cast<double>(kLargestSide));
        return std::min(4 * good_fft_size((static_cast<int>(cells) + 3) / 4), kLargestSide);
    };
    Side s{};
    if (spec.lattice)
        s.n = checked_count(name, (*spec.lattice)[static_cast<std::size_t>(axis)], kSmallestSide, kLargestGivenSide);
    if (spec.period) s.period = checked_period(name, (*spec.period)[static_cast<std::size_t>(axis)]);
    if (s.n == 0) s.n = n_for(spec.period ? s.period : wanted);
    if (!spec.period) s.period = s.n * cell;
    return s;
}

}  // namespace

std::vector<ScreenGeometry> layout_screens(const TurbulenceSpec& spec, const ShotView& view) {
    if (!(view.far > 0) || !std::isfinite(view.far))
        throw UserError(
            fmt::format("turbulence: screens need a positive, finite path; the farthest depth is {} m", view.far));
    const std::vector<double> ends = layout_slabs(spec, view.far);
    const double T = spec.period ? checked_period("t", (*spec.period)[3]) : default_loop(spec, view.fps);
    std::vector<ScreenGeometry> screens;
    for (std::size_t m = 0; m < ends.size(); ++m) {
        ScreenGeometry g;
        const double near = m > 0 ? ends[m - 1] : 0;
        g.thickness = ends[m] - near;
        g.w = 0.5 * (near + ends[m]);
        const double scale = view.perspective ? g.w : 1;
        g.aperture = view.aperture * (view.perspective ? 1 - g.w / view.far : 1);
        const double golden = static_cast<double>(m) * 0.6180339887498949;
        const double finer = 1 - 0.15 * (golden - std::floor(golden));
        const double cell =
            finer * std::max({spec.inner_scale / kCellsPerInnerScale, g.aperture / 4, view.pixel * scale});
        const Side x = side(spec, 0, 2 * view.half_width * scale, cell),
                   y = side(spec, 1, 2 * view.half_height * scale, cell);
        g.nx = x.n;
        g.ny = y.n;
        g.Lx = x.period;
        g.Ly = y.period;
        g.T = T;
        const double finest = std::min(g.Lx / g.nx, g.Ly / g.ny);
        const double states = T * std::sqrt(spec.alpha) * portable::kPi * std::sqrt(2.0) / (finest * kKnotSpacing);
        g.nt = spec.lattice
                   ? checked_count("nt", (*spec.lattice)[3], 1, kMostSamples)
                   : static_cast<int>(std::clamp(std::ceil(states / kStatesPerSample), 1.0, double{kMostSamples}));
        screens.push_back(g);
    }
    return screens;
}

std::vector<BandGeometry> screen_bands(const TurbulenceSpec& spec, const ScreenGeometry& s) {
    const bool integrate = spec.spectrum == SpectrumKind::VonKarman;
    std::vector<BandGeometry> bands{
        {s.nx, s.ny, s.Lx, s.Ly, s.T, s.nt, std::numeric_limits<int>::max(), s.thickness, s.aperture, integrate}};
    if (!integrate) return bands;
    double Lx = s.Lx, Ly = s.Ly;
    while (std::min(Lx, Ly) < kPeriodInOuterScales * spec.outer_scale) {
        Lx *= kCoarsening;
        Ly *= kCoarsening;
        bands.push_back(
            {kCoarseSide, kCoarseSide, Lx, Ly, s.T, s.nt, (kCoarsening - 1) / 2, s.thickness, s.aperture, true});
    }
    return bands;
}

std::uint64_t screens_bytes(const TurbulenceSpec& spec, const std::vector<ScreenGeometry>& screens) {
    double bytes = 0;
    for (const ScreenGeometry& s : screens)
        for (const BandGeometry& band : screen_bands(spec, s)) bytes += ScreenBand::bytes(band);
    return bytes < 0x1p64 ? static_cast<std::uint64_t>(bytes) : std::numeric_limits<std::uint64_t>::max();
}

void check_screens(const TurbulenceSpec& spec, const std::vector<ScreenGeometry>& screens, std::uint64_t memory_limit) {
    const std::uint64_t needed = screens_bytes(spec, screens);
    if (needed <= memory_limit) return;
    const ScreenGeometry& s = screens.front();
    throw UserError(fmt::format(
        "turbulence: {} screens of {} x {} need {:.1f} GB, allowed are {:.1f} GB; reduce the lattice", screens.size(),
        s.nx, s.ny, static_cast<double>(needed) * 1e-9, static_cast<double>(memory_limit) * 1e-9));
}

}  // namespace eikonal
