#include "noise/medium/medium.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

namespace eikonal {
namespace {

/// Length of a stride in longest steps.
constexpr double kStride = 2;

}  // namespace

IndexSample MediumInstant::sample(const dvec3& x) const {
    const IndexJet both = jet(x);
    return {both.n, both.gradient};
}

IndexJet MediumInstant::jet(const dvec3&) const {
    return {};
}

dvec3 MediumInstant::force(const dvec3& x, const dvec3& p) const {
    return force_jet(x, p).force;
}

ForceJet MediumInstant::force_jet(const dvec3&, const dvec3&) const {
    return {};
}

double MediumInstant::longest_stride(const dvec3& x, const dvec3& d, double) const {
    return kStride * longest_step(x, d);
}

double MediumInstant::clear_way(const dvec3&, const dvec3&) const {
    return 0;
}

double MediumInstant::way_to_edge(const dvec3&, const dvec3&) const {
    return kNever;
}

bool MediumInstant::add_bend(const dvec3&, const dvec3&, double, double, StraightBend&) const {
    return false;
}

MediumInstant::InterpolationBend MediumInstant::interpolation_bend(const dvec3&) const {
    return {};
}

Box MediumInstant::shown_box() const {
    return {dvec3(-0.5), dvec3(0.5)};
}

double Medium::farthest_part(const dvec3&) const {
    return 0;
}

FieldSlices Medium::slices(double t, const ForceLaw& law) const {
    const std::shared_ptr<const MediumInstant> instant = at(t, {.law = law});
    const dvec3 low = instant->shown_box().low, high = instant->shown_box().high;
    const dvec3 spacing = (high - low) / double{kFieldSamples - 1};
    FieldSlices slices{kFieldSamples, kFieldSamples, kFieldSamples, {}, {}, {}};
    slices.position = [=](int z) { return low.z + z * spacing.z; };
    slices.fill = [=](int z, std::span<float> values) {
        tbb::parallel_for(0, kFieldSamples, [&](int row) {
            for (int x = 0; x < kFieldSamples; ++x) {
                const IndexSample s = instant->sample(low + spacing * dvec3(x, kFieldSamples - 1 - row, z));
                float* out = &values[static_cast<std::size_t>(kFieldChannels * (row * kFieldSamples + x))];
                out[0] = static_cast<float>(law.exaggeration * s.n);
                for (int c = 0; c < 3; ++c) out[c + 1] = static_cast<float>(law.strength() * s.gradient[c]);
            }
        });
    };
    slices.describe({0, 0, 0, 0}, spacing, t);
    slices.attributes.emplace_back("eikonal/origin.x", low.x);
    slices.attributes.emplace_back("eikonal/origin.y", low.y);
    return slices;
}

void FieldSlices::describe(const double (&period)[4], const dvec3& spacing, double t) {
    for (int i = 0; i < 4; ++i) attributes.emplace_back(fmt::format("eikonal/period.{}", "xyzt"[i]), period[i]);
    for (int i = 0; i < 3; ++i) attributes.emplace_back(fmt::format("eikonal/spacing.{}", "xyz"[i]), spacing[i]);
    attributes.emplace_back("eikonal/time", t);
}

}  // namespace eikonal
