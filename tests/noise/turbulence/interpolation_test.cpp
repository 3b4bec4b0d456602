/// The error of interpolation by a lattice's spline: in the force, in the rays that it bends, and compared with the
/// error that was allowed.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "noise/air/air.h"
#include "noise/base/error.h"
#include "noise/math/random.h"
#include "noise/medium/optics.h"
#include "noise/medium/refractivity.h"
#include "noise/surface/surface_spec.h"
#include "noise/turbulence/lattice/lattice_instant.h"
#include "noise/turbulence/lattice/lattice_medium.h"
#include "noise/turbulence/parameters/turbulence_spec.h"

namespace eikonal {
namespace {

constexpr std::uint64_t kMemory = 1ULL << 31;

TurbulenceSpec air() {
    TurbulenceSpec s;
    s.form = TurbulenceForm::Lattice;
    s.cn2 = 1e-9;
    s.outer_scale = 0.5;
    s.inner_scale = 0.05;
    s.period = {0.3, 0.3, 0.3, 1};
    return s;
}

struct Draw {
    RandomStream stream{1, "interpolation test"};
    std::uint64_t next = 0;
    double operator()(double low, double high) { return low + (high - low) * stream.uniform(next++); }
    dvec3 point() { return {(*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1)}; }
    dvec3 direction() {
        dvec3 d;
        do d = point();
        while (glm::length(d) > 1 || glm::length(d) < 0.1);
        return glm::normalize(d);
    }
};

TEST(Interpolation, IsAsNearTheSumAsStated) {
    TurbulenceSpec spec = air();
    spec.lattice = {12, 12, 12, 1};
    const LatticeField lattice(spec, choose_lattice(spec));
    const LatticeInstant exact(lattice, 0.5, 12);
    Draw draw;
    for (const int padding : {1, 2, 4}) {
        const LatticeInstant spline(lattice, 0.5, padding);
        double error = 0, power = 0;
        for (int i = 0; i < 4000; ++i) {
            const dvec3 x = draw.point(), truth = exact.jet(x).gradient, off = spline.jet(x).gradient - truth;
            error += glm::dot(off, off);
            power += glm::dot(truth, truth);
        }
        const double stated = lattice_spline_error(lattice, padding).slope;
        EXPECT_NEAR(std::sqrt(error / power), stated, 0.25 * stated + 3e-5) << padding;
    }
    const Air field({spec}, {}, {.memory_limit = kMemory});
    EXPECT_GT(field.interpolation_error(), 0);
    EXPECT_LE(field.interpolation_error(), kInterpolationError);
    const AirInstant f = field.at(0.5);
    for (int i = 0; i < 100; ++i) {
        const dvec3 x = draw.point();
        EXPECT_NEAR(f.refractivity(x), index_law(OpticsSpec{}).ambient() + exact.jet(x).n,
                    1e-3 * std::sqrt(lattice.variance()));
    }
    // The result is the same on every machine, or it is refused.
    const std::uint64_t bare = lattice_bytes(spec, lattice.geometry());
    EXPECT_THROW(Air({spec}, {}, {.memory_limit = bare + 1000}), UserError);
    EXPECT_EQ(Air({spec}, {}, {.memory_limit = bare + 10'000'000}).interpolation_error(), field.interpolation_error());
    EXPECT_EQ(Air({SurfaceSpec{}}, {}, {.memory_limit = kMemory}).interpolation_error(), 0);
}

// Integrals along straight rays through a spline are compared with those through a spline so fine that it equals the
// sum. Both are computed by the midpoint rule.
TEST(Interpolation, MovesRaysByWhatIsStated) {
    TurbulenceSpec spec = air();
    spec.lattice = {16, 16, 16, 1};
    const LatticeField lattice(spec, choose_lattice(spec));
    for (const bool falls : {false, true}) {
        if (falls) spec.falloff = Falloff{.origin = {0, -1, 0}, .normal = {0, 1, 0}, .length = 2};
        const LatticeField field(spec, lattice.geometry());
        const auto exact = std::make_shared<const LatticeInstant>(field, 0, 12);
        for (const bool oblique : {false, true})
            for (const int padding : {1, 2, 4}) {
                const auto spline = std::make_shared<const LatticeInstant>(field, 0, padding);
                const OpticsSpec optics{.exaggeration = 3};
                const AirInstant f(
                    optics, {{lattice_medium_instant(spline, field, lattice_spline_error(field, padding).bend), 2}});
                Draw draw;
                double shifts = 0, turns = 0, stated_shifts = 0, stated_turns = 0;
                for (int i = 0; i < 300; ++i) {
                    const double way = 2;
                    const dvec3 from = draw.point(), d = oblique
                                                             ? draw.direction()
                                                             : glm::normalize(dvec3(0, 0, 1) + 0.1 * draw.direction());
                    const int parts = 1000;
                    dvec3 shift(0), turn(0);
                    for (int j = 0; j < parts; ++j) {
                        const double w = (j + 0.5) / parts * way;
                        const dvec3 x = from + w * d,
                                    off = 6.0 * (spline->jet(x).gradient - exact->jet(x).gradient) * (way / parts);
                        const dvec3 across = off - glm::dot(off, d) * d;
                        shift += (way - w) * across;
                        turn += across;
                    }
                    shifts += glm::dot(shift, shift);
                    turns += glm::dot(turn, turn);
                    const AirInstant::Interpolation stated = f.interpolation(from, from + way * d);
                    stated_shifts += stated.shift * stated.shift;
                    stated_turns += stated.turn * stated.turn;
                }
                const double shift = std::sqrt(shifts / stated_shifts), turn = std::sqrt(turns / stated_turns);
                const double least = oblique ? 0.3 : 0.75, most = oblique ? 1.1 : 1.25;
                EXPECT_TRUE(shift > least && shift < most) << padding << " " << oblique << " " << shift;
                EXPECT_TRUE(turn > least && turn < most) << padding << " " << oblique << " " << turn;
            }
    }
}

TEST(Interpolation, IsAsFineAsRaysNeed) {
    TurbulenceSpec spec = air();
    spec.lattice = {12, 12, 12, 1};
    const dvec3 from(0, 0, 0), to(0, 0, 10);
    for (const double exaggeration : {1.0, 100.0}) {
        const auto turn = [&](double allowed) {
            return Air({spec}, {.exaggeration = exaggeration}, {.memory_limit = kMemory, .bend_error = allowed})
                .at(0)
                .interpolation(from, to)
                .turn;
        };
        const double any = turn(std::numeric_limits<double>::infinity()), per_metre = any / std::sqrt(10.0);
        EXPECT_EQ(turn(per_metre), any);
        EXPECT_LE(turn(0.5 * per_metre), 0.5 * any);
        EXPECT_GT(turn(1e-9 * per_metre), 0) << "as fine as it may be";
    }
    EXPECT_EQ(Air({SurfaceSpec{}}, {}, {.memory_limit = kMemory}).at(0).interpolation(from, to).turn, 0);
}

}  // namespace
}  // namespace eikonal
