// Profiles, compared with their formulas and derivatives, also where they have no index.
#include "noise/profile/profile.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <string>

#include "noise/math/random.h"
#include "noise/profile/profile_spec.h"

namespace eikonal {
namespace {

using Vec = std::array<long double, 3>;

Vec vec(const dvec3& v) {
    return {v.x, v.y, v.z};
}

constexpr std::array kKinds{ProfileKind::Luneburg,      ProfileKind::FishEye,     ProfileKind::Linear,
                            ProfileKind::LinearSquared, ProfileKind::Exponential, ProfileKind::Rod,
                            ProfileKind::Sech};

ProfileSpec spec_of(ProfileKind kind) {
    ProfileSpec s;
    s.profile = kind;
    s.center = {0.3, -0.2, 0.1};
    s.axis = glm::normalize(dvec3(0.4, 1, -0.7));
    s.radius = 1.3;
    s.n0 = 1.4;
    s.slope = 0.25;
    s.g = 0.6;
    return s;
}

/// n by the table in profile.h, in 80 bits.
long double exact(const ProfileSpec& s, const Vec& x) {
    Vec v;
    long double along = 0, r2 = 0;
    for (int i = 0; i < 3; ++i) v[i] = x[i] - s.center[i];
    for (int i = 0; i < 3; ++i) along += s.axis[i] * v[i], r2 += v[i] * v[i];
    const long double rho2 = r2 - along * along, n0 = s.n0, a = s.slope, R2 = (long double)s.radius * s.radius;
    switch (s.profile) {
        case ProfileKind::Luneburg:
            return r2 < R2 ? std::sqrt(2 - r2 / R2) : 1;
        case ProfileKind::FishEye:
            return n0 / (1 + r2 / R2);
        case ProfileKind::Linear:
            return n0 + a * along;
        case ProfileKind::LinearSquared:
            return std::sqrt(n0 * n0 + a * along);
        case ProfileKind::Exponential:
            return n0 * std::exp(a * along);
        case ProfileKind::Rod:
            return n0 * std::sqrt(1 - s.g * s.g * rho2);
        case ProfileKind::Sech:
            return n0 / std::cosh(s.g * std::sqrt(rho2));
    }
    return 0;
}

TEST(Profile, IsItsFormulaWithItsDerivatives) {
    const RandomStream stream(1, "profile test");
    for (const ProfileKind kind : kKinds) {
        const ProfileSpec spec = spec_of(kind);
        const Profile profile(spec);
        for (std::uint64_t i = 0; i < 300; ++i) {
            dvec3 x;
            for (int c = 0; c < 3; ++c) x[c] = spec.center[c] + 0.9 * (2 * stream.uniform(4 * i + c) - 1);
            if (i % 3 == 0) x = spec.center + 1e-2 * (x - spec.center);  // near the axis and the centre
            const IndexJet jet = profile.jet(x);
            EXPECT_NEAR(jet.n, static_cast<double>(exact(spec, vec(x)) - 1), 1e-14) << int(kind);
            if (kind == ProfileKind::Luneburg && std::abs(glm::length(x - spec.center) - spec.radius) < 1e-3) continue;
            const long double h = 1e-4L;
            const auto at = [&](int a, long double da, int b, long double db) {
                Vec y = vec(x);
                y[a] += da;
                y[b] += db;
                return exact(spec, y);
            };
            for (int a = 0; a < 3; ++a) {
                // fourth order: h⁴
                const long double first =
                    (8 * (at(a, h, a, 0) - at(a, -h, a, 0)) - (at(a, 2 * h, a, 0) - at(a, -2 * h, a, 0))) / (12 * h);
                EXPECT_NEAR(jet.gradient[a], static_cast<double>(first), 1e-12) << int(kind);
                for (int b = 0; b < 3; ++b) {
                    const auto cross = [&](long double s) {
                        return (at(a, s, b, s) - at(a, s, b, -s) - at(a, -s, b, s) + at(a, -s, b, -s)) / (4 * s * s);
                    };
                    const long double second = (4 * cross(h) - cross(2 * h)) / 3;
                    EXPECT_NEAR(jet.hessian[b][a], static_cast<double>(second), 1e-10) << int(kind) << a << b;
                }
            }
        }
    }
}

// ∇²(n²): -6/R² in Luneburg's lens, 0 where n² is linear, -4 n0² g² in the rod.
TEST(Profile, LaplaciansOfTheSquare) {
    const auto laplacian = [](const IndexJet& j) {
        const double trace = j.hessian[0][0] + j.hessian[1][1] + j.hessian[2][2];
        return 2 * ((1 + j.n) * trace + glm::dot(j.gradient, j.gradient));
    };
    for (const auto& [kind, truth] : {std::pair{ProfileKind::Luneburg, -6 / (1.3 * 1.3)},
                                      {ProfileKind::LinearSquared, 0.0},
                                      {ProfileKind::Rod, -4 * 1.4 * 1.4 * 0.36}})
        EXPECT_NEAR(laplacian(Profile(spec_of(kind)).jet({0.5, 0.3, -0.4})), truth, 1e-13) << int(kind);
}

TEST(Profile, WithoutAnIndexSaysSoAndBendsNothing) {
    ProfileSpec s = spec_of(ProfileKind::Linear);
    for (const ProfileKind kind : {ProfileKind::Linear, ProfileKind::LinearSquared}) {
        s.profile = kind;
        const IndexJet jet = Profile(s).jet(s.center - 100.0 * s.axis);
        EXPECT_EQ(jet.n, -1);
        EXPECT_EQ(jet.gradient, dvec3(0));
        EXPECT_EQ(jet.hessian, glm::dmat3(0));
    }
    s.profile = ProfileKind::Rod;
    EXPECT_EQ(Profile(s).jet(s.center + 50.0 * glm::cross(s.axis, dvec3(1, 0, 0))).n, -1);
}

TEST(Profile, StaysFinite) {
    for (const ProfileKind kind : kKinds)
        for (const double far : {1e3, 1e30, 1e160, 1e307})
            for (const double slope : {-1e200, -0.3, 0.0, 1e200}) {
                ProfileSpec s = spec_of(kind);
                s.slope = slope;
                for (const dvec3& x : {far * s.axis, -far * s.axis, far * dvec3(1, -1, 0.3), dvec3(far, far, far)}) {
                    const IndexJet jet = Profile(s).jet(x);
                    EXPECT_TRUE(std::isfinite(jet.n));
                    for (int i = 0; i < 3; ++i) {
                        EXPECT_TRUE(std::isfinite(jet.gradient[i]));
                        for (int j = 0; j < 3; ++j) EXPECT_TRUE(std::isfinite(jet.hessian[i][j]));
                    }
                }
            }
}

TEST(Profile, EdgesAreWhereTheForceJumps) {
    const RandomStream stream(2, "profile test");
    int met = 0;
    for (const ProfileKind kind : kKinds) {
        const ProfileSpec spec = spec_of(kind);
        const Profile profile(spec);
        const auto force = [&](const dvec3& x) {
            const IndexJet j = profile.jet(x);
            return (1 + j.n) * j.gradient;
        };
        for (std::uint64_t i = 0; i < 300; ++i) {
            dvec3 x, d;
            for (int c = 0; c < 3; ++c) {
                x[c] = 8 * stream.uniform(8 * i + c) - 4;
                d[c] = 2 * stream.uniform(8 * i + 4 + c) - 1;
            }
            d = glm::normalize(d);
            EXPECT_GT(profile.scale(x), 0);
            // Every jump along 12 m is found in advance. The test goes from edge to edge with probes between them.
            const double clear = profile.clear_way(x, d);
            double w = 0;
            while (w < 12) {
                const double edge = w + profile.way_to_edge(x + w * d, d), end = std::min(edge, 12.0);
                ASSERT_GT(edge, w);
                dvec3 last = force(x + (w + 1e-9) * d);
                for (double at = w + 1e-9; at < end; at += 5e-3) {
                    const dvec3 here = force(x + at * d);
                    EXPECT_LT(glm::length(here - last), 0.05 * (1 + glm::length(last)))
                        << int(kind) << ' ' << at << ' ' << edge;
                    if (at < clear) {
                        EXPECT_EQ(here, dvec3(0));
                    }
                    last = here;
                }
                if (end < 12 && glm::length(force(x + (end - 1e-7) * d) - force(x + (end + 1e-7) * d)) > 1e-3) ++met;
                w = end + 1e-9;
            }
        }
    }
    EXPECT_GT(met, 100);
}

}  // namespace
}  // namespace eikonal
