// Births, lives, cooling and places of blobs, and what is refused.
#include "noise/blobs/blobs.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <thread>

#include "noise/base/error.h"
#include "noise/blobs/blob_instant.h"
#include "noise/blobs/blobs_spec.h"
#include "noise/medium/optics.h"

namespace eikonal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

IndexLaw law() {
    return index_law({});
}

BlobSourceSpec source_spec() {
    BlobSourceSpec source;
    source.from = {-1, 0, 2};
    source.to = {1, 0.5, 2};
    source.rate = 60;
    source.sigma = 0.05;
    source.growth = 1e-3;
    return source;
}

BlobsSpec plume() {
    BlobsSpec spec;
    spec.sources = {source_spec()};
    spec.wind = WindSpec{};
    return spec;
}

bool same(const std::vector<Blob>& a, const std::vector<Blob>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Blob& p, const Blob& q) {
        return p.center == q.center && p.sigma == q.sigma && p.n == q.n;
    });
}

std::string message_of(const BlobsSpec& spec) {
    try {
        const BlobCloud cloud(spec, law(), "medium.3");
    } catch (const UserError& error) {
        return error.what();
    }
    return "";
}

TEST(BlobCloud, ExplicitBlobsStayAsStated) {
    BlobsSpec spec = plume();
    spec.sources.clear();
    spec.blobs = {{{1, 2, 3}, 0.2, 900}, {{0, 0, 0}, 0.1, 250}};
    const BlobCloud cloud(spec, law(), "medium.0");
    for (const double t : {0.0, -5.0, 1e9, 1e300}) {
        const std::vector<Blob> blobs = cloud.at(t);
        ASSERT_EQ(blobs.size(), 2U);
        EXPECT_EQ(blobs[0].center, dvec3(1, 2, 3));
        EXPECT_EQ(blobs[0].sigma, 0.2);
        EXPECT_EQ(blobs[0].n, law().above_ambient(900));
        EXPECT_LT(blobs[0].n, 0);
        EXPECT_GT(blobs[1].n, 0);
    }
}

TEST(BlobCloud, AMillionAtATimeOverAllMedia) {
    BlobsSpec spec;
    spec.sources = {{.rate = 1000, .lifetime = 500}};
    EXPECT_EQ(BlobCloud(spec, law(), "medium.1", 4e5).most(), 500001);
    EXPECT_THROW(BlobCloud(spec, law(), "medium.1", 6e5), UserError);
}

TEST(BlobCloud, NothingToEmitIsEmpty) {
    BlobsSpec spec = plume();
    spec.sources[0].rate = 0;
    EXPECT_TRUE(BlobCloud(spec, law(), "medium.0").at(3).empty());
    EXPECT_TRUE(BlobCloud({}, law(), "medium.0").at(3).empty());
}

TEST(BlobCloud, BirthsAreOneAnIntervalForEver) {
    // The number of blobs alive is rate × lifetime within two, in any window of time. Their places fill the segment
    // evenly.
    BlobsSpec spec = plume();
    spec.wind.reset();
    spec.sources[0].lifetime = 10;
    const BlobCloud cloud(spec, law(), "medium.0");
    double sum = 0, sum2 = 0, count = 0;
    for (const double t : {0.0, -1e9, 1e9, 33.3, -7.0, 123456.7}) {
        const std::vector<Blob> blobs = cloud.at(t);
        EXPECT_NEAR(blobs.size(), 600, 2) << t;
        EXPECT_LE(blobs.size(), cloud.most());
        for (const Blob& blob : blobs) {
            const double part = (blob.center.x + 1) / 2;
            EXPECT_GE(part, 0);
            EXPECT_LE(part, 1);
            EXPECT_NEAR(blob.center.y, part * 0.5, 1e-12);
            sum += part;
            sum2 += part * part;
            ++count;
        }
    }
    EXPECT_NEAR(sum / count, 0.5, 4 / std::sqrt(12 * count));
    EXPECT_NEAR(sum2 / count - sum * sum / (count * count), 1.0 / 12, 0.006);
}

TEST(BlobCloud, BlobsLiveForExactlyTheirLifetime) {
    // Without wind, its place identifies a blob. Its age, seen as σ² = σ0² + growth age, grows from 0 to the lifetime.
    BlobsSpec spec = plume();
    spec.wind.reset();
    const BlobSourceSpec& source = spec.sources[0];
    const BlobCloud cloud(spec, law(), "medium.0");
    const double t = 17.2;
    const auto age = [&](const Blob& blob) {
        return (blob.sigma * blob.sigma - source.sigma * source.sigma) / source.growth;
    };
    const std::vector<Blob> blobs = cloud.at(t);
    for (std::size_t i = 0; i < blobs.size(); ++i) {
        EXPECT_GE(age(blobs[i]), 0);
        EXPECT_LT(age(blobs[i]), source.lifetime + 1e-9);
        EXPECT_LE(age(blobs[i]), age(blobs[i > 0 ? i - 1 : 0]));
    }
    const double death = t + source.lifetime - age(blobs[100]);
    const auto alive = [&](double when) {
        const std::vector<Blob> now = cloud.at(when);
        return std::any_of(now.begin(), now.end(), [&](const Blob& b) { return b.center == blobs[100].center; });
    };
    EXPECT_TRUE(alive(death - 1e-6));
    EXPECT_FALSE(alive(death + 1e-6));
    EXPECT_TRUE(alive(death - source.lifetime + 1e-6));
    EXPECT_FALSE(alive(death - source.lifetime - 1e-6));
}

TEST(BlobCloud, CoolsAndGrowsAsStated) {
    BlobsSpec spec = plume();
    spec.wind.reset();
    spec.sources[0].cooling = 0.3;
    const BlobSourceSpec& source = spec.sources[0];
    for (const Blob& blob : BlobCloud(spec, law(), "medium.0").at(3)) {
        const double age = (blob.sigma * blob.sigma - source.sigma * source.sigma) / source.growth;
        if (age < kBirthPart * source.lifetime || age > (1 - kFadePart) * source.lifetime) continue;
        const double T = 293.15 + (1000 - 293.15) * std::exp(-0.3 * age) * std::pow(source.sigma / blob.sigma, 3);
        EXPECT_NEAR(blob.n / (law().at(T) - law().at(293.15)), 1, 1e-9);
    }
}

TEST(BlobCloud, CooledBlobsHaveNoIndex) {
    BlobsSpec spec = plume();
    spec.sources[0].cooling = 100;
    const std::vector<Blob> blobs = BlobCloud(spec, law(), "medium.0").at(3);
    EXPECT_NEAR(blobs.size(), 300, 2);
    EXPECT_EQ(blobs.front().n, 0);
    EXPECT_LT(BlobInstant(blobs).lower_bound(), 0);
    spec.sources[0].temperature = OpticsSpec{}.ambient_temperature;
    EXPECT_TRUE(BlobInstant(BlobCloud(spec, law(), "medium.0").at(3)).empty());
}

TEST(BlobCloud, NothingPopsFromFrameToFrame) {
    // In a thousandth of a second no blob moves far. The total heat changes smoothly through births and deaths.
    BlobsSpec spec = plume();
    spec.sources[0].cooling = 0;
    spec.sources[0].growth = 0;
    const BlobCloud cloud(spec, law(), "medium.0");
    const double full = std::abs(law().above_ambient(1000));
    const double dt = 1e-3;
    const auto heat_at = [&](double t) {
        double sum = 0;
        for (const Blob& blob : cloud.at(t)) sum += blob.n;
        return sum;
    };
    double before = heat_at(4);
    for (int i = 1; i < 400; ++i) {
        const double heat = heat_at(4 + i * dt);
        // ramps: 16 and 30 blobs at most at once, each by less than 1.5 dt/ramp
        EXPECT_LT(std::abs(heat - before), full * 1.5 * dt * (16 / 0.25 + 32 / 0.5));
        before = heat;
    }
    std::vector<Blob> last = cloud.at(4);
    for (int i = 1; i < 400; ++i) {
        const std::vector<Blob> now = cloud.at(4 + i * dt);
        // Blobs are born at the end of the list and die at its beginning. A new blob is cold, and an old one has faded.
        for (const Blob& blob : now) {
            double nearest = kInfinity;
            for (const Blob& b : last) nearest = std::min(nearest, glm::length(b.center - blob.center));
            EXPECT_LT(std::abs(blob.n), nearest > 8 * dt ? 1e-3 * full : 1.001 * full);
        }
        last = now;
    }
}

TEST(BlobCloud, WindCarriesBlobsAlongTheExactPath) {
    // Every blob's place against a fine integration of Wind::velocity from its birth; up to half a turnover of age.
    BlobsSpec spec = plume();
    spec.wind->seed = 9;
    spec.sources[0].lifetime = 1;  // half of L0/rms = 2 s
    spec.sources[0].to.reset();
    spec.sources[0].rate = 30;
    const BlobSourceSpec& source = spec.sources[0];
    const BlobCloud cloud(spec, law(), "medium.0");
    const Wind wind(*spec.wind, source.lifetime);
    double error2 = 0, way2 = 0, count = 0;
    for (const double t : {5.03, -40.1, 700.77}) {
        for (const Blob& blob : cloud.at(t)) {
            const double age = (blob.sigma * blob.sigma - source.sigma * source.sigma) / source.growth;
            dvec3 x = source.from;
            constexpr int steps = 150;
            const double h = age / steps;
            for (int s = 0; s < steps; ++s) {
                const double now = t - age + s * h;
                const dvec3 middle = x + 0.5 * h * wind.velocity(x, now);
                x += h * wind.velocity(middle, now + 0.5 * h);
            }
            error2 += glm::dot(x - blob.center, x - blob.center);
            const dvec3 way = x - source.from - age * spec.wind->rise;
            way2 += glm::dot(way, way);
            ++count;
        }
    }
    EXPECT_GT(count, 80);
    EXPECT_LE(std::sqrt(error2 / count), kWindTrackError * spec.wind->outer_scale);
    EXPECT_GE(std::sqrt(way2 / count), 0.2);
}

TEST(BlobCloud, RiseAloneIsExact) {
    BlobsSpec spec = plume();
    spec.wind->rms = 5e-324;
    spec.wind->rise = {0.5, 2, 0};
    spec.sources[0].to.reset();
    const BlobSourceSpec& source = spec.sources[0];
    for (const Blob& blob : BlobCloud(spec, law(), "medium.0").at(1e6)) {
        const double age = (blob.sigma * blob.sigma - source.sigma * source.sigma) / source.growth;
        EXPECT_LT(glm::length(blob.center - source.from - age * spec.wind->rise), 1e-9);
    }
}

TEST(BlobCloud, IsAFunctionOfTimeAlone) {
    BlobsSpec spec = plume();
    spec.sources.push_back(source_spec());
    spec.sources[1].lifetime = 1.7;
    spec.sources[1].from.z = 5;
    spec.sources.push_back(source_spec());
    spec.sources[2].lifetime = 0.01;  // less than a step of the wind
    spec.sources[2].rate = 3000;
    std::vector<double> times{0, 0.04, 0.08, -3, 200, 0.05, 0.5, 1e9, 2.5, 0.3, -1e9};
    const double step = Wind(*spec.wind, 5).step();
    for (const int k : {1, 7, 100003}) times.insert(times.end(), {k * step, std::nextafter(k * step, 0)});
    std::vector<std::vector<Blob>> fresh;
    for (const double t : times) fresh.push_back(BlobCloud(spec, law(), "medium.0").at(t));
    const BlobCloud cloud(spec, law(), "medium.0");
    for (std::size_t i = 0; i < times.size(); ++i) EXPECT_TRUE(same(cloud.at(times[i]), fresh[i])) << times[i];
    for (std::size_t i = times.size(); i-- > 0;) EXPECT_TRUE(same(cloud.at(times[i]), fresh[i])) << times[i];
    for (const int threads : {1, 2}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        EXPECT_TRUE(same(BlobCloud(spec, law(), "medium.0").at(times[4]), fresh[4]));
    }
    std::vector<std::thread> users;
    std::array<bool, 3> all{true, true, true};
    for (std::size_t u = 0; u < all.size(); ++u)
        users.emplace_back([&, u] {
            for (std::size_t round = 0; round < 20; ++round) {
                const std::size_t i = (round * (u + 3) + u) % times.size();
                all[u] = all[u] && same(cloud.at(times[i]), fresh[i]);
            }
        });
    for (std::thread& user : users) user.join();
    for (const bool a : all) EXPECT_TRUE(a);
}

TEST(BlobCloud, SeedsDecide) {
    BlobsSpec spec = plume();
    const auto blobs = BlobCloud(spec, law(), "medium.0").at(2);
    spec.seed = 2;
    EXPECT_FALSE(same(BlobCloud(spec, law(), "medium.0").at(2), blobs));
    spec.seed = 1;
    spec.wind->seed = 2;
    EXPECT_FALSE(same(BlobCloud(spec, law(), "medium.0").at(2), blobs));
}

TEST(BlobCloud, RefusesWhatItCannotHold) {
    const auto expect = [](const char* text, const std::function<void(BlobsSpec&)>& change) {
        BlobsSpec spec = plume();
        spec.blobs.resize(2);
        spec.sources.push_back(source_spec());
        change(spec);
        EXPECT_NE(message_of(spec).find(text), std::string::npos) << message_of(spec) << " lacks " << text;
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(message_of(plume()), "");
    expect("medium.3.blob.1.temperature", [](BlobsSpec& s) { s.blobs[1].temperature = 0; });
    expect("medium.3.blob.0.sigma", [](BlobsSpec& s) { s.blobs[0].sigma = -1; });
    expect("medium.3.blob.0.center", [&](BlobsSpec& s) { s.blobs[0].center.y = nan; });
    expect("medium.3.source.1.rate", [](BlobsSpec& s) { s.sources[1].rate = -1; });
    expect("medium.3.source.1.lifetime", [](BlobsSpec& s) { s.sources[1].lifetime = 0; });
    expect("medium.3.source.0.sigma", [&](BlobsSpec& s) { s.sources[0].sigma = nan; });
    expect("medium.3.source.0.temperature", [](BlobsSpec& s) { s.sources[0].temperature = -3; });
    expect("medium.3.source.0.to", [](BlobsSpec& s) { s.sources[0].to = dvec3(0, 0, kInfinity); });
    expect("medium.3.source.0.growth", [](BlobsSpec& s) { s.sources[0].growth = -1e-9; });
    expect("medium.3.source.0.cooling", [](BlobsSpec& s) { s.sources[0].cooling = kInfinity; });
    expect("medium.3.wind.rms", [](BlobsSpec& s) { s.wind->rms = 1e300; });
    expect("medium.3.wind.outer_scale", [](BlobsSpec& s) { s.wind->outer_scale = 0; });
    expect("medium.3.wind.rise", [&](BlobsSpec& s) { s.wind->rise.x = nan; });
    expect("medium.3.source.1.rate = 1e+09", [](BlobsSpec& s) { s.sources[1].rate = 1e9; });
    expect("allowed are 1000000", [](BlobsSpec& s) { s.sources[1].rate = 1e9; });
    expect("medium.3.source.1.rate", [](BlobsSpec& s) { s.sources[0].rate = s.sources[1].rate = 1.2e5; });
}

TEST(BlobCloud, ExtremesStayFinite) {
    for (const double scale : {1e-6, 1.0, 1e6}) {
        BlobsSpec spec = plume();
        BlobSourceSpec& source = spec.sources[0];
        source.sigma = scale;
        source.growth = 1e12;
        source.cooling = scale * scale;
        source.temperature = scale < 1 ? 1 : 1e9;
        source.lifetime = 1000 * scale;
        source.rate = 100 / source.lifetime;
        spec.wind->rms = scale;
        spec.wind->outer_scale = 1 / scale;
        spec.wind->rise = {1e6, -1e6, 0};
        const BlobCloud cloud(spec, law(), "medium.0");
        for (const double t : {0.0, -kLatestTime}) {
            const std::vector<Blob> blobs = cloud.at(t);
            EXPECT_GT(blobs.size(), 90);
            const BlobInstant instant(blobs);
            for (const Blob& blob : blobs) {
                EXPECT_TRUE(std::isfinite(blob.n) && std::isfinite(blob.sigma) && std::isfinite(blob.center.x) &&
                            std::isfinite(blob.center.y) && std::isfinite(blob.center.z));
                const IndexJet jet = instant.jet(blob.center + 0.3 * blob.sigma);
                EXPECT_TRUE(std::isfinite(jet.n) && std::isfinite(jet.gradient.x) && std::isfinite(jet.hessian[0][1]));
            }
            for (const double far : {1e150, -1e300}) {
                EXPECT_EQ(instant.sample({far, 0, far}).n, 0);
                EXPECT_GT(instant.longest_step({far, 0, far}), 0);
                EXPECT_GE(instant.clear_way({far, 0, far}, {1, 0, 0}), 0);
            }
        }
    }
}

}  // namespace
}  // namespace eikonal
