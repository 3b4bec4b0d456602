// The sum of a scene's media: index, force, jets, steps and edges, for each kind alone and together.
// Length: every property is checked for every kind of medium, on the scenes at the top.
#include "noise/air/air.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <array>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "noise/base/error.h"
#include "noise/blobs/blobs_spec.h"
#include "noise/math/random.h"
#include "noise/medium/medium_spec.h"
#include "noise/medium/optics.h"
#include "noise/medium/refractivity.h"
#include "noise/profile/profile_spec.h"
#include "noise/surface/surface_spec.h"
#include "noise/turbulence/gradient_noise/gradient_noise.h"
#include "noise/turbulence/lattice/lattice_instant.h"
#include "noise/turbulence/parameters/turbulence_spec.h"
#include "noise/turbulence/screens/screen_force.h"
#include "noise/turbulence/screens/screens.h"

namespace eikonal {
namespace {

constexpr std::uint64_t kMemory = 1ULL << 31;

TurbulenceSpec turbulence(TurbulenceForm form, bool falloff = false) {
    TurbulenceSpec s;
    s.form = form;
    s.cn2 = 1e-9;
    s.outer_scale = 0.5;
    s.inner_scale = 0.05;
    s.velocity = {0.3, 0.1, -0.2};
    if (form == TurbulenceForm::Lattice) {
        s.lattice = {20, 24, 18, 4};
        s.period = {0.5, 0.6, 0.45, 3};
    }
    if (falloff) s.falloff = Falloff{{0.1, 0.05, -0.2}, glm::normalize(dvec3(0.2, 1, 0.3)), 0.4};
    return s;
}

SurfaceSpec surface() {
    SurfaceSpec s;
    s.origin = {0, -0.1, 0};
    s.surface_temperature = 330;
    s.dropoff = 0.08;
    return s;
}

BlobsSpec blobs() {
    BlobsSpec b;
    b.blobs = {{{0.2, 0.1, -0.4}, 0.12, 1000}, {{-0.3, 0.3, -0.9}, 0.05, 600}, {{0.1, 0.2, -2.4}, 0.3, 200}};
    return b;
}

ProfileSpec fish_eye() {
    ProfileSpec p;
    p.profile = ProfileKind::FishEye;
    p.radius = 0.7;
    p.n0 = 2;
    return p;
}

ShotFrame frame() {
    ShotFrame f;
    f.origin = {0.1, 0.2, 0.3};
    f.forward = glm::normalize(dvec3(0.2, -0.1, -1));
    f.right = glm::normalize(glm::cross(f.forward, dvec3(0, 1, 0)));
    f.up = glm::cross(f.right, f.forward);
    f.view = {true, 6, 0.4, 0.3, 2e-3, 0, 24};
    return f;
}

Air make(const std::vector<MediumSpec>& media, const OpticsSpec& optics = {}) {
    return {media, optics, {frame(), kMemory}};
}

/// Every kind of medium by itself.
std::vector<std::pair<std::string, MediumSpec>> kinds() {
    return {{"lattice", turbulence(TurbulenceForm::Lattice)},
            {"lattice with falloff", turbulence(TurbulenceForm::Lattice, true)},
            {"noise", turbulence(TurbulenceForm::GradientNoise)},
            {"noise with falloff", turbulence(TurbulenceForm::GradientNoise, true)},
            {"screens", turbulence(TurbulenceForm::Screens)},
            {"screens with falloff", turbulence(TurbulenceForm::Screens, true)},
            {"surface", surface()},
            {"blobs", blobs()},
            {"profile", fish_eye()}};
}

struct Draw {
    RandomStream stream{1, "field test"};
    std::uint64_t next = 0;
    double operator()(double low, double high) { return low + (high - low) * stream.uniform(next++); }
    dvec3 point() { return {(*this)(-0.6, 0.6), (*this)(-0.1, 0.6), (*this)(-3, 0.2)}; }
    dvec3 direction() {
        dvec3 d;
        do d = {(*this)(-1, 1), (*this)(-1, 1), (*this)(-1, 1)};
        while (glm::length(d) > 1 || glm::length(d) < 0.1);
        return glm::normalize(d);
    }
};

/// Central differences of the fourth order.
template <class F>
auto derivative(F&& f, double h) {
    return (8.0 * (f(h) - f(-h)) - (f(2 * h) - f(-2 * h))) / (12 * h);
}

dvec3 unit(int axis) {
    dvec3 e(0);
    e[axis] = 1;
    return e;
}

double largest(const glm::dmat3& m) {
    double most = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) most = std::max(most, std::abs(m[i][j]));
    return most;
}

/// Whether the points of a difference lie on both sides of a jump of F, or of a kink of a spline's Hessian at a cell.
bool straddles(const AirInstant& f, const dvec3& x, double h) {
    for (int a = 0; a < 3; ++a)
        for (const double sign : {-1.0, 1.0})
            if (f.way_to_edge(x, sign * unit(a)) < h) return true;
    return false;
}

TEST(Air, ForceIsTheGradientOfTheIndexAndItsJetTheDerivativeOfTheForce) {
    Draw draw;
    for (const RayEquation equation : {RayEquation::Physical, RayEquation::Paper})
        for (const auto& [name, spec] : kinds()) {
            const Air field = make({spec}, OpticsSpec{.ray_equation = equation, .exaggeration = 3});
            const AirInstant f = field.at(0.7);
            const bool screens = name.starts_with("screens");
            double force_scale = 0, jet_scale = 0, direction_scale = 0;
            for (int i = 0; i < 100; ++i) {
                const ForceJet jet = f.force_jet(draw.point(), {0.1, 0.05, -1});
                force_scale = std::max(force_scale, glm::length(jet.force));
                jet_scale = std::max(jet_scale, largest(jet.by_position));
                direction_scale = std::max(direction_scale, largest(jet.by_direction));
            }
            EXPECT_EQ(direction_scale > 0, screens);
            for (int i = 0; i < 100; ++i) {
                const dvec3 x = draw.point(), p = 1.2 * draw.direction();
                const double h = 1e-5, n_step = 1e-4;
                if (straddles(f, x, 1e-3) || (screens && std::abs(glm::dot(p, frame().forward)) < 0.3)) continue;
                const ForceJet jet = f.force_jet(x, p);
                const dvec3 force = f.force(x, p);
                EXPECT_LE(glm::length(jet.force - force), 1e-12 * force_scale) << name;
                for (int a = 0; a < 3; ++a) {
                    if (!screens) {
                        // F = ½∇|dx/du|²
                        const double speed2 = derivative(
                            [&](double s) {
                                const double v = f.speed(x + s * unit(a));
                                return v * v;
                            },
                            n_step);
                        EXPECT_NEAR(force[a], 0.5 * speed2, 1e-4 * force_scale) << name;
                    }
                    const dvec3 by_x = derivative([&](double s) { return f.force(x + s * unit(a), p); }, h);
                    EXPECT_LE(glm::length(jet.by_position[a] - by_x), 3e-3 * jet_scale) << name << ' ' << a;
                    if (!screens) continue;
                    const dvec3 by_p = derivative([&](double s) { return f.force(x, p + s * unit(a)); }, h);
                    EXPECT_LE(glm::length(jet.by_direction[a] - by_p), 3e-2 * direction_scale) << name << ' ' << a;
                }
            }
        }
}

TEST(Air, JetsAreTheDerivativesOfTheirOwnGradient) {
    Draw draw;
    const LatticeField lattice(turbulence(TurbulenceForm::Lattice, true),
                               choose_lattice(turbulence(TurbulenceForm::Lattice)));
    const LatticeInstant snapshot(lattice, 0.3);
    const GradientNoiseField noise(turbulence(TurbulenceForm::GradientNoise, true));
    const ShotView view = frame().view;
    const TurbulenceSpec screens_spec = turbulence(TurbulenceForm::Screens);
    const ScreenField screens(screens_spec, layout_screens(screens_spec, view), frame().right, frame().up);
    const ScreenInstant screen = screens.at(0.2)[2];
    double largest_n = 0, largest_slope = 0;
    for (int i = 0; i < 300; ++i) {
        const dvec3 x = draw.point();
        const double h = 1e-7;
        const auto check = [&](const IndexSample& s, const IndexJet& j, auto&& sample, double tolerance) {
            EXPECT_NEAR(s.n, j.n, 1e-12 * std::abs(j.n) + 1e-18);
            for (int a = 0; a < 3; ++a) {
                const dvec3 change = (sample(x + h * unit(a)).gradient - sample(x - h * unit(a)).gradient) / (2 * h);
                EXPECT_LE(glm::length(change - j.hessian[a]), tolerance * largest(j.hessian)) << a;
                for (int b = 0; b < a; ++b) EXPECT_NEAR(j.hessian[a][b], j.hessian[b][a], 1e-12 * largest(j.hessian));
            }
        };
        const auto lattice_at = [&](const dvec3& y) { return snapshot.smooth_sample(y); };
        check(lattice_at(x), snapshot.jet(x), lattice_at, 1e-3);
        // The warp's single precision must give the same function.
        const IndexSample rough = snapshot.sample(x);
        largest_n = std::max(largest_n, std::abs(rough.n));
        largest_slope = std::max(largest_slope, glm::length(rough.gradient));
        EXPECT_NEAR(rough.n, snapshot.jet(x).n, 2e-6 * largest_n + 1e-12);
        EXPECT_LE(glm::length(rough.gradient - snapshot.jet(x).gradient), 1e-4 * largest_slope);
        const auto noise_at = [&](const dvec3& y) { return noise.sample(y, 0.4); };
        check(noise_at(x), noise.jet(x, 0.4), noise_at, 1e-4);
        const auto at = [&](double dx, double dy) { return screen.jet(x.x + dx, x.y + dy); };
        const PeriodicSpline2::Jet j = at(0, 0);
        const double curvature = std::abs(j.dxx) + std::abs(j.dxy) + std::abs(j.dyy);
        EXPECT_NEAR((at(h, 0).dx - at(-h, 0).dx) / (2 * h), j.dxx, 1e-3 * curvature);
        EXPECT_NEAR((at(0, h).dx - at(0, -h).dx) / (2 * h), j.dxy, 1e-3 * curvature);
        EXPECT_NEAR((at(h, 0).dy - at(-h, 0).dy) / (2 * h), j.dxy, 1e-3 * curvature);
        EXPECT_NEAR((at(0, h).dy - at(0, -h).dy) / (2 * h), j.dyy, 1e-3 * curvature);
        EXPECT_NEAR((at(1e-4, 0).value - at(-1e-4, 0).value) / 2e-4, j.dx,
                    1e-5 * (std::abs(j.dx) + std::abs(j.dy)) + 1e-5 * curvature);
    }
}

TEST(Air, MediaAddUp) {
    Draw draw;
    std::vector<MediumSpec> all;
    std::vector<Air> alone;
    for (const auto& [name, spec] : kinds()) {
        if (name == "profile") continue;
        all.push_back(spec);
        alone.push_back(make({spec}, OpticsSpec{.ray_equation = RayEquation::Paper}));
    }
    const AirInstant together = make(all, OpticsSpec{.ray_equation = RayEquation::Paper}).at(1.3);
    std::vector<AirInstant> parts;
    for (const Air& f : alone) parts.push_back(f.at(1.3));
    const double ambient = index_law(OpticsSpec{}).ambient();
    for (int i = 0; i < 100; ++i) {
        const dvec3 x = draw.point(), d = draw.direction();
        dvec3 force(0);
        glm::dmat3 by_position(0), by_direction(0);
        double above = 0, step = INFINITY, directed = INFINITY, clear = INFINITY, edge = INFINITY;
        for (const AirInstant& f : parts) {
            force += f.force(x, d);
            by_position += f.force_jet(x, d).by_position;
            by_direction += f.force_jet(x, d).by_direction;
            above += f.refractivity(x) - ambient;
            step = std::min(step, f.longest_step(x));
            directed = std::min(directed, f.longest_step(x, d));
            clear = std::min(clear, f.clear_way(x, d));
            edge = std::min(edge, f.way_to_edge(x, d));
        }
        EXPECT_LE(glm::length(together.force(x, d) - force), 1e-14 * glm::length(force) + 1e-18);
        EXPECT_LE(largest(together.force_jet(x, d).by_position - by_position), 1e-13 * largest(by_position));
        EXPECT_LE(largest(together.force_jet(x, d).by_direction - by_direction), 1e-13 * largest(by_direction));
        EXPECT_NEAR(together.refractivity(x), ambient + above, 1e-18 + 1e-14 * ambient);
        EXPECT_EQ(together.longest_step(x), step);
        EXPECT_EQ(together.longest_step(x, d), directed);
        EXPECT_EQ(together.clear_way(x, d), clear);
        EXPECT_EQ(together.way_to_edge(x, d), edge);
        EXPECT_LE(step, directed);
    }
}

TEST(Air, ExaggerationMultipliesWhatIsAboveAmbient) {
    Draw draw;
    const double ambient = index_law(OpticsSpec{}).ambient();
    for (const auto& [name, spec] : kinds()) {
        const AirInstant once = make({spec}, OpticsSpec{.ray_equation = RayEquation::Paper}).at(0);
        const AirInstant five = make({spec}, OpticsSpec{.ray_equation = RayEquation::Paper, .exaggeration = 5}).at(0);
        const double factor = name == "profile" ? 1 : 5, base = name == "profile" ? 0 : ambient;
        for (int i = 0; i < 20; ++i) {
            const dvec3 x = draw.point(), d = draw.direction();
            EXPECT_NEAR(five.refractivity(x) - base, factor * (once.refractivity(x) - base), 1e-14) << name;
            EXPECT_LE(glm::length(five.force(x, d) - factor * once.force(x, d)), 1e-13 * glm::length(five.force(x, d)))
                << name;
        }
    }
}

TEST(Air, ConventionsDifferByHalfAndTheSpeed) {
    const AirInstant physical = make({blobs()}).at(0);
    const AirInstant paper = make({blobs()}, OpticsSpec{.ray_equation = RayEquation::Paper}).at(0);
    const dvec3 x(0.25, 0.15, -0.42), p(0, 0, -1);
    const double n = 1 + physical.refractivity(x);
    EXPECT_DOUBLE_EQ(physical.speed(x), n);
    EXPECT_DOUBLE_EQ(paper.speed(x), std::sqrt(n));
    EXPECT_LE(glm::length(physical.force(x, p) - 2 * n * paper.force(x, p)), 1e-15 * glm::length(physical.force(x, p)));
}

TEST(Air, MediaWithoutStrengthAreLeftOut) {
    TurbulenceSpec calm = turbulence(TurbulenceForm::Lattice);
    calm.cn2 = 0;
    SurfaceSpec mild = surface();
    mild.surface_temperature = OpticsSpec{}.ambient_temperature;
    for (const Air& field :
         {make({}), make({calm, mild, BlobsSpec{}}), make({blobs(), surface()}, OpticsSpec{.exaggeration = 0})}) {
        EXPECT_FALSE(field.bends());
        const AirInstant f = field.at(2);
        EXPECT_EQ(f.force({0.2, 0.1, -0.4}, {0, 0, -1}), dvec3(0));
        EXPECT_EQ(f.refractivity({0.2, 0.1, -0.4}), index_law(OpticsSpec{}).ambient());
        EXPECT_EQ(f.clear_way({0, 0, 0}, {0, 0, -1}), INFINITY);
        EXPECT_EQ(f.longest_step({0, 0, 0}), INFINITY);
        EXPECT_EQ(f.way_to_edge({0, 0, 0}, {0, 0, -1}), INFINITY);
    }
    EXPECT_TRUE(make({surface()}).bends());
}

TEST(Air, WithoutAnIndexNothingBends) {
    const AirInstant f = make({blobs()}, OpticsSpec{.exaggeration = 1e5}).at(0);
    const dvec3 inside(0.2, 0.13, -0.4);
    EXPECT_LE(f.refractivity(inside), -1);
    EXPECT_EQ(f.speed(inside), 0);
    EXPECT_EQ(f.force(inside, {0, 0, -1}), dvec3(0));
    EXPECT_EQ(largest(f.force_jet(inside, {0, 0, -1}).by_position), 0);
}

// The bend of a straight ray through screens is what the warp sums: √L³ lever_m(D) M ∇⊥(gψ_m). Each screen turns the
// ray by √L |∇⊥(gψ_m)| in every direction across it. In the plane of slant the part of the bend is L times as long on
// the screen as across the ray.
TEST(Air, ScreensBendStraightRaysAsTheWarpDoes) {
    Draw draw;
    for (const bool falloff : {false, true})
        for (const RayEquation equation : {RayEquation::Physical, RayEquation::Paper}) {
            const TurbulenceSpec spec = turbulence(TurbulenceForm::Screens, falloff);
            const ShotFrame fr = frame();
            const OpticsSpec optics{.ray_equation = equation, .exaggeration = 2};
            const AirInstant f = make({spec}, optics).at(0.4);
            const ScreenField screens(spec, layout_screens(spec, fr.view), fr.right, fr.up);
            const std::vector<ScreenInstant> at = screens.at(0.4);
            ASSERT_GE(at.size(), 4u);
            for (int i = 0; i < 50; ++i) {
                const double sx = draw(-0.8, 0.8), sy = draw(-0.6, 0.6), D = draw(0.3, 9.0);
                const dvec3 along = fr.forward + sx * fr.right + sy * fr.up;
                const double L = glm::length(along);
                dvec3 expected(0);
                double scale = 0;
                for (const ScreenInstant& s : at) {
                    const double lever = slab_lever(s.w() - 0.5 * s.thickness(), s.w() + 0.5 * s.thickness(), D).length;
                    const PeriodicSpline2::Sample psi = s.sample(s.w() * sx, s.w() * sy);
                    dvec3 bend = double{psi.dx} * fr.right + double{psi.dy} * fr.up;
                    if (falloff) {
                        const IndexSample g = falloff_at(*spec.falloff, fr.origin + s.w() * along);
                        bend = g.n * bend +
                               double{psi.value} * (g.gradient - glm::dot(g.gradient, fr.forward) * fr.forward);
                    }
                    const dvec3 slant = glm::normalize(sx * fr.right + sy * fr.up), d = along / L;
                    const dvec3 slanted = bend + (L - 1) * glm::dot(bend, slant) * slant;
                    EXPECT_NEAR(glm::length(slanted - glm::dot(slanted, d) * d), glm::length(bend),
                                1e-12 * glm::length(bend));
                    const dvec3 part = force_strength(optics) * L * std::sqrt(L) * lever * slanted;
                    expected += part;
                    scale += glm::length(part);
                }
                // F is constant between edges: ∫(U - u) F du exactly
                const dvec3 d = along / L;
                const double U = D * L;
                dvec3 x1(0);
                double u = 0;
                while (u < U) {
                    const double end = std::min(U, u + f.way_to_edge(fr.origin + u * d, d)), middle = 0.5 * (u + end);
                    x1 += (end - u) * (U - middle) * f.force(fr.origin + middle * d, d);
                    u = end + 1e-12;
                }
                EXPECT_LE(glm::length(x1 - expected), 1e-4 * scale);
                // Backwards along the same line the air is the same.
                EXPECT_LE(glm::length(f.force(fr.origin + 0.5 * U * d, d) - f.force(fr.origin + 0.5 * U * d, -d)),
                          1e-12 * scale);
            }
        }
}

TEST(Air, ScreensAreNotThereBeforeTheFrameNorBehindTheFarEnd) {
    const ShotFrame fr = frame();
    const AirInstant f = make({turbulence(TurbulenceForm::Screens)}).at(0);
    const dvec3 d = fr.forward;
    EXPECT_EQ(f.force(fr.origin - 0.1 * d, d), dvec3(0));
    EXPECT_EQ(f.force(fr.origin + 6.1 * d, d), dvec3(0));
    EXPECT_NE(f.force(fr.origin + 5.9 * d, d), dvec3(0));
    EXPECT_NEAR(f.clear_way(fr.origin - 0.5 * d, d), 0.5, 1e-12);
    EXPECT_NEAR(f.clear_way(fr.origin + 7.0 * d, -d), 1, 1e-12);
    EXPECT_EQ(f.clear_way(fr.origin + 7.0 * d, d), INFINITY);
    EXPECT_EQ(f.force(fr.origin + d, fr.right), dvec3(0));
    EXPECT_EQ(f.force(fr.origin + d, fr.right + d / (1.01 * kSteepestRay)), dvec3(0));
}

/// ∫F du and ∫|F| du along a straight line between edges, in steps of part · longest_step.
struct Integral {
    dvec3 bend{0};
    double total = 0;
};
Integral integrate(const AirInstant& f, const dvec3& x0, const dvec3& d, double length, int finer) {
    // Gauss-Legendre, five points
    constexpr std::array<double, 5> kNode{0.046910077030668, 0.230765344947158, 0.5, 0.769234655052842,
                                          0.953089922969332};
    constexpr std::array<double, 5> kWeight{0.118463442528095, 0.239314335249683, 0.284444444444444, 0.239314335249683,
                                            0.118463442528095};
    Integral sum;
    double u = 0;
    while (u < length) {
        const dvec3 x = x0 + u * d;
        const double clear = f.clear_way(x, d);
        double step = std::min({clear > 0 ? clear : f.longest_step(x, d), f.way_to_edge(x, d) + 1e-13, length - u});
        EXPECT_GT(step, 0);
        for (int part = 0; part < finer; ++part)
            for (std::size_t k = 0; k < 5; ++k) {
                const dvec3 F = f.force(x + step * (part + kNode[k]) / double(finer) * d, d);
                sum.bend += step / finer * kWeight[k] * F;
                sum.total += step / finer * kWeight[k] * glm::length(F);
                if (clear > 0) {
                    EXPECT_LE(glm::length(F), 1e-12);
                }
            }
        u += step;
    }
    return sum;
}

TEST(Air, StepsMissNothing) {
    Draw draw;
    SurfaceSpec scorching = surface();
    scorching.surface_temperature = 1e9;
    SurfaceSpec cold = surface();
    cold.surface_temperature = 30;
    std::vector<std::pair<std::string, MediumSpec>> all = kinds();
    all.emplace_back("scorching surface", scorching);
    all.emplace_back("cold surface", cold);
    for (const auto& [name, spec] : all) {
        const AirInstant f = make({spec}).at(0.1);
        int met = 0;
        for (int i = 0; i < 60; ++i) {
            const dvec3 target = draw.point();
            dvec3 d = draw.direction();
            if (i % 2 == 0) d = glm::normalize(d * dvec3(1, 0.02, 1));  // grazing
            const dvec3 x0 = target - draw(0, 4) * d;
            const Integral coarse = integrate(f, x0, d, 8, 1), fine = integrate(f, x0, d, 8, 8);
            met += fine.total > 0;
            EXPECT_LE(glm::length(coarse.bend - fine.bend), 0.01 * fine.total + 1e-15) << name << ' ' << i;
        }
        EXPECT_GT(met, 20) << name;
    }
}

// A thin layer of one medium far away is reached by steps that end before it, in whatever direction the ray goes.
TEST(Air, StepsAndClearWaysReachThinThings) {
    SurfaceSpec thin = surface();
    thin.dropoff = 1e-5;
    BlobsSpec small;
    small.blobs = {{{3, 5, -40}, 1e-4, 900}};
    for (const MediumSpec& spec : {MediumSpec(thin), MediumSpec(small)}) {
        const AirInstant f = make({spec}).at(0);
        const dvec3 x0(0.3, 2, 1),
            aim = (spec.get_if<SurfaceSpec>() != nullptr) ? dvec3(9, -0.1, -30) : dvec3(3, 5.00005, -40);
        const dvec3 d = glm::normalize(aim - x0);
        const double clear = f.clear_way(x0, d);
        EXPECT_GT(clear, 10);
        EXPECT_LT(clear, glm::length(aim - x0));
        EXPECT_LE(f.longest_step(x0), glm::length(aim - x0) + 1e-3);
        double w = 0, most = 0;
        for (int i = 0; i < 1000 && w < 60; ++i) {
            most = std::max(most, glm::length(f.force(x0 + w * d, d)));
            w += std::max(f.longest_step(x0 + w * d), 1e-12);
        }
        EXPECT_GT(most, 0.01);
    }
}

TEST(Air, GrazingRaysOverASurfaceTakeFewSteps) {
    const AirInstant f = make({surface()}).at(0);
    const dvec3 x(0, -0.09, 0), grazing = glm::normalize(dvec3(1, -1e-3, 0));
    EXPECT_GT(f.longest_step(x, grazing), 20 * f.longest_step(x));
    EXPECT_GT(f.longest_step({0, 3, 0}, grazing), 1);
}

// |dx/du| = speed along any ray. The ray grazes a hot surface within its critical slope and goes through blobs and a
// lattice.
TEST(Air, RaysKeepTheirSpeed) {
    for (const RayEquation equation : {RayEquation::Physical, RayEquation::Paper}) {
        const OpticsSpec optics{.ray_equation = equation, .exaggeration = 20};
        const AirInstant f = make({surface(), blobs(), turbulence(TurbulenceForm::Lattice)}, optics).at(0.2);
        dvec3 x(-0.2, 0.02, 0), p = f.speed(x) * glm::normalize(dvec3(0.1, -0.02, -1));
        double lowest = x.y;
        const double h = 1e-3;
        for (int i = 0; i < 10000; ++i) {
            // Runge-Kutta of the fourth order for (x, p)
            const dvec3 a = f.force(x, p), b = f.force(x + 0.5 * h * p, p),
                        c = f.force(x + 0.5 * h * p + 0.25 * h * h * a, p), d = f.force(x + h * p + 0.5 * h * h * b, p);
            x += h * p + h * h / 6 * (a + b + c);
            p += h / 6 * (a + 2.0 * b + 2.0 * c + d);
            lowest = std::min(lowest, x.y);
            ASSERT_NEAR(glm::length(p), f.speed(x), 1e-9);
        }
        EXPECT_GT(lowest, surface().origin.y);  // turned back above the surface
        EXPECT_GT(p.y, 0);
    }
}

TEST(Air, SameBitsForAnyNumberOfThreads) {
    std::vector<MediumSpec> all;
    for (const auto& [name, spec] : kinds())
        if (name != "profile") all.push_back(spec);
    const auto values = [&](std::size_t threads) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        const AirInstant f = make(all).at(12.34);
        Draw draw;
        std::vector<double> out;
        for (int i = 0; i < 50; ++i) {
            const dvec3 x = draw.point(), d = draw.direction();
            const ForceJet jet = f.force_jet(x, d);
            for (int a = 0; a < 3; ++a) {
                out.push_back(jet.force[a]);
                for (int b = 0; b < 3; ++b) out.push_back(jet.by_position[a][b] + jet.by_direction[a][b]);
            }
            out.push_back(f.longest_step(x, d));
        }
        return out;
    };
    const std::vector<double> one = values(1), two = values(2);
    ASSERT_EQ(one.size(), two.size());
    EXPECT_EQ(std::memcmp(one.data(), two.data(), one.size() * sizeof(double)), 0);
}

TEST(Air, RefusesWithTheMediumsName) {
    const auto message = [](auto&& make_it) -> std::string {
        try {
            make_it();
        } catch (const UserError& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_NE(message([] { make({surface(), fish_eye()}); }).find("medium.1: a profile"), std::string::npos);
    EXPECT_NE(message([] { make({fish_eye(), surface()}); }).find("medium.0: a profile"), std::string::npos);
    EXPECT_NE(message([] {
                  Air({surface(), turbulence(TurbulenceForm::Lattice)}, {}, {.memory_limit = 1000});
              }).find("medium.1: "),
              std::string::npos);
    EXPECT_NE(message([] {
                  Air({turbulence(TurbulenceForm::Screens)}, {}, {frame(), 1000});
              }).find("medium.0: "),
              std::string::npos);
    EXPECT_THROW(Air({turbulence(TurbulenceForm::Screens)}, {}, {.memory_limit = kMemory}), std::logic_error);
}

}  // namespace
}  // namespace eikonal
