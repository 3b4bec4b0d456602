#include "noise/turbulence/screens/screens.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "noise/base/error.h"
#include "noise/math/bessel.h"
#include "noise/math/portable_math.h"
#include "noise/turbulence/parameters/turbulence_spec.h"

namespace eikonal {

PeriodicSpline2::Sample ScreenInstant::sample(double x, double y) const {
    PeriodicSpline2::Sample sum;
    for (const auto& band : bands_) {
        const PeriodicSpline2::Sample s = band->sample(x - drift_x_, y - drift_y_);
        sum.value += s.value;
        sum.dx += s.dx;
        sum.dy += s.dy;
    }
    return sum;
}

PeriodicSpline2::Jet ScreenInstant::jet(double x, double y) const {
    PeriodicSpline2::Jet sum;
    for (const auto& band : bands_) {
        const PeriodicSpline2::Jet s = band->jet(x - drift_x_, y - drift_y_);
        sum.value += s.value;
        sum.dx += s.dx;
        sum.dy += s.dy;
        sum.dxx += s.dxx;
        sum.dxy += s.dxy;
        sum.dyy += s.dyy;
    }
    return sum;
}

ScreenInstant::Columns ScreenInstant::columns(double x0, double step_x, int n) const {
    Columns result;
    for (const auto& band : bands_) result.push_back(band->columns(x0 - drift_x_, step_x, n));
    return result;
}

void ScreenInstant::add_gradients(const Columns& columns, double y, float weight, float* uv) const {
    for (std::size_t i = 0; i < bands_.size(); ++i) bands_[i]->add_row_gradients(columns[i], y - drift_y_, weight, uv);
}

void ScreenInstant::add_values(const Columns& columns, double y, float weight, float* values) const {
    for (std::size_t i = 0; i < bands_.size(); ++i) bands_[i]->add_row_values(columns[i], y - drift_y_, weight, values);
}

namespace {

/// Variance of ∂ψ/∂x [rad²] beyond the Nyquist wavenumber of a screen: 2π²δ ∫ k³Φ jinc²(kA/2) dk. The square of the
/// lattice's wavenumbers is replaced by a circle of the same area.
double lost_gradient_variance(const TurbulenceSpec& spec, const ScreenGeometry& s, const Spectrum& spectrum) {
    if (spec.spectrum == SpectrumKind::Paper) return 0;
    constexpr double kBeyondInnerScale = 4;
    constexpr int kSteps = 256;
    const double lowest = std::sqrt(4 * portable::kPi * (s.nx / s.Lx) * (s.ny / s.Ly));
    const double highest = kBeyondInnerScale * kInnerScaleConstant / spec.inner_scale;
    if (!(highest > lowest)) return 0;
    const double ratio = portable::pow(highest / lowest, 1.0 / kSteps);
    double sum = 0, k = lowest * std::sqrt(ratio);
    for (int i = 0; i < kSteps; ++i, k *= ratio) {
        const double filter = s.aperture > 0 ? jinc(0.5 * s.aperture * k) : 1;
        sum += k * k * k * k * spectrum(k * k) * filter * filter;
    }
    return 2 * portable::kPi * portable::kPi * s.thickness * sum * portable::log(ratio);
}

}  // namespace

ScreenField::ScreenField(const TurbulenceSpec& spec, std::vector<ScreenGeometry> screens, const dvec3& e1,
                         const dvec3& e2)
    : screens_(std::move(screens)), velocity_x_(glm::dot(spec.velocity, e1)), velocity_y_(glm::dot(spec.velocity, e2)) {
    constexpr std::uint64_t kBandsPerScreen = 256;
    for (std::size_t m = 0; m < screens_.size(); ++m) {
        const ScreenGeometry& s = screens_[m];
        const double tall = s.Lx / s.Ly * (s.ny / 2), finest = std::sqrt(0.25 * s.nx * s.nx + tall * tall);
        if (spec.spectrum == SpectrumKind::Paper && spec.lowest_wavenumber > finest)
            throw UserError(
                fmt::format("turbulence: lowest_wavenumber = {:g} cycles is beyond the finest eddies of {:.4g} of a "
                            "screen of {} x {} samples, so that none are left; lower it, or give a larger lattice",
                            spec.lowest_wavenumber, finest, s.nx, s.ny));
        const Spectrum spectrum(spec, spec.lowest_wavenumber * portable::kTwoPi / s.Lx);
        std::vector<ScreenBand>& bands = bands_.emplace_back();
        for (const BandGeometry& g : screen_bands(spec, screens_[m]))
            bands.emplace_back(spec, spectrum, g, m * kBandsPerScreen + bands.size());
        lost_.push_back(lost_gradient_variance(spec, s, spectrum));
    }
}

std::vector<ScreenInstant> ScreenField::at(double t) const {
    std::vector<ScreenInstant> out(screens_.size());
    std::vector<std::pair<std::size_t, std::size_t>> jobs;
    for (std::size_t m = 0; m < screens_.size(); ++m) {
        const ScreenGeometry& g = screens_[m];
        out[m].w_ = g.w;
        out[m].thickness_ = g.thickness;
        out[m].cell_ = std::min(g.Lx / g.nx, g.Ly / g.ny);
        out[m].drift_x_ = velocity_x_ * t;
        out[m].drift_y_ = velocity_y_ * t;
        out[m].bands_.resize(bands_[m].size());
        for (std::size_t b = 0; b < bands_[m].size(); ++b) jobs.emplace_back(m, b);
    }
    tbb::parallel_for(std::size_t{0}, jobs.size(), [&](std::size_t i) {
        const auto [m, b] = jobs[i];
        out[m].bands_[b] = bands_[m][b].at(t);
    });
    return out;
}

double ScreenField::gradient_variance(std::size_t screen) const {
    double sum = 0;
    for (const ScreenBand& band : bands_[screen]) sum += 0.5 * (band.slope_variance_x() + band.slope_variance_y());
    return sum;
}

double ScreenField::lever(std::size_t screen, double D) const {
    const ScreenGeometry& g = screens_[screen];
    return slab_lever(g.w - 0.5 * g.thickness, g.w + 0.5 * g.thickness, D).length / D;
}

double ScreenField::displacement_angle_variance(double D) const {
    double sum = 0;
    for (std::size_t m = 0; m < screens_.size(); ++m) sum += lever(m, D) * lever(m, D) * gradient_variance(m);
    return sum;
}

double ScreenField::lost_angle_variance(double D) const {
    double sum = 0;
    for (std::size_t m = 0; m < screens_.size(); ++m) sum += lever(m, D) * lever(m, D) * lost_[m];
    return sum;
}

double ScreenField::arrival_angle_variance() const {
    double sum = 0;
    for (std::size_t m = 0; m < screens_.size(); ++m) sum += gradient_variance(m);
    return sum;
}

double ScreenField::focusing_variance(double D, bool perspective) const {
    double sum = 0;
    for (std::size_t m = 0; m < screens_.size(); ++m) {
        const double weight = lever(m, D) * (perspective ? screens_[m].w : D);
        double curvature = 0;
        for (const ScreenBand& band : bands_[m]) curvature += band.curvature_variance();
        sum += weight * weight * curvature;
    }
    return sum;
}

}  // namespace eikonal
