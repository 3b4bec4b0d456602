// Growth of displacement with path length (PHYSICS.md#first-order), as CSV: rms of x1 of the exact spectral tables,
// expected and realised, and of the paper's single table c·u. Rebuilds noise/turbulence/lattice/growth.png with
// noise/turbulence/lattice/growth.gp (noise/README.md).
#include <fmt/format.h>

#include <cmath>

#include "noise/turbulence/lattice/lattice.h"
#include "noise/turbulence/lattice/path_tables.h"
#include "noise/turbulence/parameters/turbulence_spec.h"

int main() {
    using namespace eikonal;
    TurbulenceSpec spec;
    spec.form = TurbulenceForm::Lattice;
    spec.cn2 = 1e-12;
    spec.outer_scale = 0.5;
    spec.inner_scale = 0.12;
    spec.alpha = 0;
    const LatticeGeometry geometry{{64, 64, 64, 1}, {4, 4, 4, 1}};
    const PathRays rays;
    constexpr int kRealisations = 6, kSamples = 64;
    const double far = geometry.period[2];
    std::vector<double> u;
    for (int i = 0; i <= 24; ++i) u.push_back(far * std::pow(10.0, -2.5 + 2.5 * i / 24));
    std::vector<double> realised(u.size());
    for (int r = 0; r < kRealisations; ++r) {
        spec.seed = static_cast<std::uint64_t>(r);
        const auto tables = path_tables(LatticeField(spec, geometry), 0, rays, u, 1);
        for (std::size_t i = 0; i < u.size(); ++i)
            for (int a = 0; a < kSamples; ++a)
                for (int b = 0; b < kSamples; ++b)
                    for (const PeriodicSpline2& x1 : tables[i].displacement) {
                        const double v =
                            x1.sample(static_cast<double>(a) / kSamples, static_cast<double>(b) / kSamples).value;
                        realised[i] += v * v / (kRealisations * kSamples * kSamples);
                    }
    }
    const LatticeField field(spec, geometry);
    const auto expected = [&](double path) {
        const auto v = field.displacement_variance(rays.axis, path, 0);
        return std::sqrt(v[0] + v[1]);
    };
    fmt::print("u,expected,realised,table\n");
    for (std::size_t i = 0; i < u.size(); ++i)
        fmt::print("{:.5g},{:.5g},{:.5g},{:.5g}\n", u[i], expected(u[i]), std::sqrt(realised[i]),
                   expected(far) * u[i] / far);
}
