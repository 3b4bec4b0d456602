#include "noise/turbulence/lattice/lattice_medium.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "noise/base/error.h"
#include "noise/medium/optics.h"
#include "noise/turbulence/parameters/falloff_bounds.h"
#include "noise/turbulence/parameters/turbulence_spec.h"

namespace eikonal {
namespace {

/// A step is at most this part of the finest feature; so many of them are one of a method that controls its error.
constexpr double kPartOfCell = 0.5, kLatticeStride = 3;
/// Bytes a node of an instant while it is made: its spectrum, samples and coefficients.
constexpr double kInstantBytes = 12;

double longest_lattice_step(const LatticeField& field) {
    const LatticeGeometry& g = field.geometry();
    double finest = std::min({g.spacing(0), g.spacing(1), g.spacing(2)});
    if (field.spec().spectrum == SpectrumKind::VonKarman) finest = std::max(finest, 0.5 * field.spec().inner_scale);
    return kPartOfCell * finest;
}

class Instant final : public MediumInstant {
  public:
    Instant(std::shared_ptr<const LatticeInstant> spline, const LatticeField& field, double bend_error)
        : bounds_{field.spec().falloff, longest_lattice_step(field)},
          spline_(std::move(spline)),
          bend_error_(bend_error) {}

    IndexSample sample(const dvec3& x) const override { return spline_->smooth_sample(x); }
    IndexJet jet(const dvec3& x) const override { return spline_->jet(x); }
    double longest_step(const dvec3& x, const dvec3&) const override { return bounds_.longest_step(x); }
    double longest_stride(const dvec3& x, const dvec3&, double) const override {
        return kLatticeStride * bounds_.longest_step(x);
    }
    double clear_way(const dvec3& x, const dvec3& d) const override { return bounds_.clear_way(x, d); }
    double way_to_edge(const dvec3& x, const dvec3& d) const override { return bounds_.way_to_edge(x, d); }
    InterpolationBend interpolation_bend(const dvec3& x) const override {
        if (bend_error_ == 0) return {};
        return {bend_error_, bounds_.falloff ? falloff_at(*bounds_.falloff, x).n : 1};
    }

  private:
    FalloffBounds bounds_;
    std::shared_ptr<const LatticeInstant> spline_;
    double bend_error_;
};

double spline_bytes(const LatticeGeometry& geometry, int padding) {
    return padding > 1 ? kInstantBytes * static_cast<double>(geometry.spatial_samples()) * padding * padding * padding
                       : 0.0;
}

}  // namespace

SplineChoice choose_spline(const LatticeField& field, const SplineLimits& limits) {
    SplineChoice choice{1, lattice_spline_error(field, 1)};
    const auto within = [&] { return choice.error.slope <= limits.slope && choice.error.bend <= limits.bend; };
    for (const int p : {2, 3, 4, 5, 6, kFinestPadding}) {
        const double nodes = static_cast<double>(field.geometry().spatial_samples()) * p * p * p;
        if (within() || p > limits.most_padding || nodes > limits.most_nodes) break;
        choice = {p, lattice_spline_error(field, p)};
    }
    choice.within = within();
    return choice;
}

LatticeMedium::LatticeMedium(const TurbulenceSpec& spec, const MediumSetting& setting) {
    const LatticeGeometry geometry = choose_lattice(spec);
    check_lattice(spec, geometry, setting.budget->memory);
    setting.budget->take_memory(lattice_bytes(spec, geometry));
    field_ = std::make_shared<const LatticeField>(spec, geometry);
    note_ = fmt::format("lattice {} x {} x {} x {}", geometry.size[0], geometry.size[1], geometry.size[2],
                        geometry.size[3]);
    if (setting.lattice_splines) make_spline_choice(setting);
}

void LatticeMedium::make_spline_choice(const MediumSetting& setting) {
    const LatticeGeometry& geometry = field_->geometry();
    const double strength = std::abs(force_strength(setting.optics));
    spline_ = choose_spline(*field_, {.bend = setting.bend_error / strength});
    const double bytes = spline_bytes(geometry, spline_->padding), free = static_cast<double>(setting.budget->memory);
    if (bytes > free)
        throw UserError(fmt::format(
            "lattice {} x {} x {}: its spline, {} times finer, needs {:.1f} GB of memory and {:.1f} GB "
            "are free for it; choose a smaller lattice",
            geometry.size[0], geometry.size[1], geometry.size[2], spline_->padding, bytes / 1e9, free / 1e9));
    setting.budget->take_memory(static_cast<std::uint64_t>(bytes));
    note_ += fmt::format(", its spline {} times finer, whose force is off by {:.2g} of its rms{}", spline_->padding,
                         spline_->error.slope, spline_->within ? "" : "; no finer one is made");
}

std::shared_ptr<const MediumInstant> lattice_medium_instant(std::shared_ptr<const LatticeInstant> spline,
                                                            const LatticeField& field, double bend_error) {
    return std::make_shared<const Instant>(std::move(spline), field, bend_error);
}

std::shared_ptr<const MediumInstant> LatticeMedium::at(double t, const InstantSettings&) const {
    if (!spline_) throw std::logic_error("LatticeMedium: built without splines for rays");
    return lattice_medium_instant(std::make_shared<const LatticeInstant>(*field_, t, spline_->padding), *field_,
                                  spline_->error.bend);
}

std::string LatticeMedium::warning() const {
    const std::array<int, 4>& n = field_->geometry().size;
    if (!field_->spec().lattice || std::count(n.begin(), n.begin() + 3, 2) < 2) return {};
    return fmt::format(
        "moves nothing: of two samples a period, as in its lattice [{}], no wave has a slope that bends light; give it "
        "4 "
        "or more in x, y and z",
        fmt::join(n, ", "));
}

FieldSlices LatticeMedium::slices(double t, const ForceLaw& law) const {
    const LatticeGeometry g = field_->geometry();
    auto nodes = std::make_shared<std::array<FftVector<float>, kFieldChannels>>();
    constexpr std::array kComponents{Component::Index, Component::ForceX, Component::ForceY, Component::ForceZ};
    for (std::size_t c = 0; c < kFieldChannels; ++c) (*nodes)[c] = node_field(*field_, t, kComponents[c]);
    FieldSlices slices{g.size[2], g.size[0], g.size[1], {}, [g](int z) { return z * g.spacing(2); }, {}};
    slices.fill = [=](int z, std::span<float> values) {
        const auto nx = static_cast<std::size_t>(g.size[0]), ny = static_cast<std::size_t>(g.size[1]),
                   nz = static_cast<std::size_t>(g.size[2]);
        for (std::size_t row = 0; row < ny; ++row)
            for (std::size_t x = 0; x < nx; ++x) {
                const std::size_t node = (x * ny + ny - 1 - row) * nz + static_cast<std::size_t>(z);
                float* out = &values[kFieldChannels * (row * nx + x)];
                for (std::size_t c = 0; c < kFieldChannels; ++c)
                    out[c] = (*nodes)[c][node] * static_cast<float>(c == 0 ? law.exaggeration : law.strength());
            }
    };
    slices.describe({g.period[0], g.period[1], g.period[2], g.period[3]}, {g.spacing(0), g.spacing(1), g.spacing(2)},
                    t);
    return slices;
}

}  // namespace eikonal
