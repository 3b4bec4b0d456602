/// The path of a ray as text: smooth up to its end, the perturbed curve of first and second order, and its tolerance.
#include "reference/trace/path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <sstream>

#include "reference/trace/bent_ray.h"
#include "tests/reference/trace/bent_ray_scenes.h"

namespace eikonal::reference {
namespace {

TEST(Path, IsWrittenSmoothlyUpToItsEnd) {
    const TestAir air({profile(ProfileKind::Luneburg)});
    TraceSettings settings = usual();
    settings.u_end = 5;
    const auto wall = geometry({plane({1.5, 0, 0}, {-1, 0, 0})});
    std::ostringstream text;
    const BentHit hit = write_path(air.now, wall.get(), {-2, 0.5, 0}, {1, 0, 0}, settings, text, "ray.csv");
    ASSERT_TRUE(hit.hit);
    std::istringstream lines(text.str());
    std::string line;
    std::getline(lines, line);
    EXPECT_EQ(line, "u,x,y,z,px,py,pz");
    int rows = 0;
    double u_before = -1;
    std::array<double, 7> row{};
    dvec3 direction(1, 0, 0);
    while (std::getline(lines, line)) {
        std::replace(line.begin(), line.end(), ',', ' ');
        std::istringstream numbers(line);
        for (double& number : row) numbers >> number;
        EXPECT_GT(row[0], u_before);
        u_before = row[0];
        const dvec3 d = glm::normalize(dvec3(row[4], row[5], row[6]));
        EXPECT_LE(glm::length(d - direction), 1.2 * kPathTurn);
        direction = d;
        ++rows;
    }
    EXPECT_GT(rows, 40);
    EXPECT_EQ(row[0], hit.at.u);
    EXPECT_EQ(dvec3(row[1], row[2], row[3]), hit.at.x);
}

// x0(u) + x1(u) from the origin on, and p its derivative; what second order adds is closer to the bent ray.
TEST(Path, OfFirstAndSecondOrderIsThePerturbedCurve) {
    const double sigma = 0.3;
    OpticsSpec strong;
    strong.exaggeration = 20;
    const TestAir air({one_blob({2, -0.2, 0}, sigma)}, strong);
    const auto wall = geometry({plane({5, 0, 0}, {-1, 0, 0.3})});
    const dvec3 origin{0, 0, 0}, d{1, 0, 0};
    const double speed = air.now.speed(origin);
    TraceSettings settings = usual();
    settings.perspective = false;
    settings.tolerance_px = 1e-6;
    settings.pixel = 1;
    settings.u_end = 10;
    std::ostringstream ignored;
    const BentHit truth = write_path(air.now, wall.get(), origin, d, settings, ignored, "ray.csv");
    double error[2];
    for (const bool second : {false, true}) {
        settings.integrator = second ? Integrator::SecondOrder : Integrator::FirstOrder;
        std::stringstream text;
        const BentHit hit = write_path(air.now, wall.get(), origin, d, settings, text, "ray.csv");
        ASSERT_TRUE(hit.hit);
        EXPECT_NEAR(glm::dot(hit.at.x - dvec3(5, 0, 0), glm::normalize(dvec3(-1, 0, 0.3))), 0, 1e-12);
        EXPECT_GT(hit.length, glm::length(hit.at.x));
        error[second] = glm::length(hit.at.x - truth.at.x);
        std::string line;
        std::getline(text, line);
        std::vector<RayState> rows;
        while (std::getline(text, line)) {
            std::replace(line.begin(), line.end(), ',', ' ');
            std::istringstream numbers(line);
            RayState& row = rows.emplace_back();
            numbers >> row.u >> row.x.x >> row.x.y >> row.x.z >> row.p.x >> row.p.y >> row.p.z;
        }
        ASSERT_GT(rows.size(), 10u);
        EXPECT_EQ(rows.front().u, 0);
        EXPECT_EQ(rows.front().x, origin);
        EXPECT_EQ(rows.front().p, speed * d);
        EXPECT_EQ(rows.back().x, hit.at.x);
        for (std::size_t i = 1; i < rows.size(); ++i) {
            const double h = rows[i].u - rows[i - 1].u;
            const dvec3 mean = 0.5 * (rows[i].p + rows[i - 1].p);
            EXPECT_LE(glm::length((rows[i].x - rows[i - 1].x) / h - mean), 2e-4) << i;
        }
        if (second) continue;
        // By Simpson's rule: x1(u) = ∫ (u - w) F(x0(w)) dw.
        const RayState& end = rows.back();
        constexpr int kParts = 2000;
        dvec3 x1(0);
        for (int i = 0; i <= kParts; ++i) {
            const double w = end.u * i / kParts, weight = i == 0 || i == kParts ? 1 : i % 2 ? 4 : 2;
            x1 += weight * (end.u - w) * air.now.force(origin + w * speed * d, speed * d);
        }
        x1 *= end.u / (3 * kParts);
        EXPECT_LE(glm::length(origin + end.u * speed * d + x1 - end.x), 1e-6);
        EXPECT_GT(glm::length(x1), 1e-3);
    }
    EXPECT_LT(error[1], 0.3 * error[0]);
}

// In a rod F = -w² x⊥, w = n0 g, so that x1 and x2 of a straight ray are polynomials.
TEST(Path, OfFirstAndSecondOrderKeepsTheTolerance) {
    ProfileSpec rod = profile(ProfileKind::Rod);
    rod.axis = {0, 0, 1};
    rod.n0 = 1.5;
    rod.g = 0.05;
    const TestAir air({rod});
    const dvec3 origin{0.5, 0.2, 0}, d = glm::normalize(dvec3(0.05, 0, 1));
    const double u = 20, w2 = 1.5 * 1.5 * 0.05 * 0.05, speed = air.now.speed(origin);
    for (const bool second : {false, true})
        for (const double tolerance : {1e-5, 1e-8, 1e-11}) {
            TraceSettings settings = usual();
            settings.integrator = second ? Integrator::SecondOrder : Integrator::FirstOrder;
            settings.perspective = false;
            settings.pixel = 1;
            settings.tolerance_px = tolerance;
            settings.u_end = u;
            std::ostringstream ignored;
            const BentHit end = write_path(air.now, nullptr, origin, d, settings, ignored, "ray.csv");
            EXPECT_EQ(end.end, BentHit::End::Escaped);
            for (int k = 0; k < 2; ++k) {
                const double a = origin[k], b = speed * d[k];
                double x = a + b * u - w2 * (a * u * u / 2 + b * std::pow(u, 3) / 6);
                if (second) x += w2 * w2 * (a * std::pow(u, 4) / 24 + b * std::pow(u, 5) / 120);
                EXPECT_NEAR(end.at.x[k], x, tolerance) << second << k;
            }
        }
}

}  // namespace
}  // namespace eikonal::reference
