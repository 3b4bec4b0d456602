#include "noise/blobs/blobs.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <utility>

#include "noise/base/error.h"
#include "noise/blobs/blobs_spec.h"
#include "noise/math/portable_math.h"

namespace eikonal {
namespace {

constexpr double kCalm = 1e-12;  ///< rms [m/s] that moves nothing by a millimetre within kLatestTime
constexpr int kIntervalsAtOnce = 4;
constexpr std::size_t kMostCarriedKept = 16;
constexpr std::size_t kBlobsAtOnce = 32;  ///< least that a thread is given

void require(const std::string& key, double value, const BlobKeyRange& allowed) {
    if (!(value >= allowed.least && value <= allowed.most))
        throw UserError(fmt::format("{} = {:g} {} is out of range; allowed is {:g} … {:g} {}", key, value, allowed.unit,
                                    allowed.least, allowed.most, allowed.unit));
}

void require(const std::string& key, const dvec3& value, const BlobKeyRange& allowed) {
    for (int axis = 0; axis < 3; ++axis) require(fmt::format("{}.{}", key, axis), value[axis], allowed);
}

void require_all(const BlobsSpec& spec, std::string_view name) {
    for (std::size_t j = 0; j < spec.blobs.size(); ++j) {
        const auto key = [&](const char* last) { return fmt::format("{}.blob.{}.{}", name, j, last); };
        require(key("center"), spec.blobs[j].center, kBlobPlace);
        require(key("sigma"), spec.blobs[j].sigma, kBlobSigma);
        require(key("temperature"), spec.blobs[j].temperature, kBlobTemperature);
    }
    for (std::size_t m = 0; m < spec.sources.size(); ++m) {
        const BlobSourceSpec& s = spec.sources[m];
        const auto key = [&](const char* last) { return fmt::format("{}.source.{}.{}", name, m, last); };
        require(key("from"), s.from, kBlobPlace);
        if (s.to) require(key("to"), *s.to, kBlobPlace);
        require(key("rate"), s.rate, kBlobRate);
        require(key("temperature"), s.temperature, kBlobTemperature);
        require(key("sigma"), s.sigma, kBlobSigma);
        require(key("cooling"), s.cooling, kBlobCooling);
        require(key("growth"), s.growth, kBlobGrowth);
        require(key("lifetime"), s.lifetime, kBlobLifetime);
    }
    if (!spec.wind) return;
    const auto key = [&](const char* last) { return fmt::format("{}.wind.{}", name, last); };
    require(key("rms"), spec.wind->rms, kWindSpeed);
    require(key("outer_scale"), spec.wind->outer_scale, kWindOuterScale);
    require(key("rise"), spec.wind->rise, kWindRise);
}

/// Largest number of blobs alive; UserError if it is above kMostBlobs with the earlier ones.
double count(const BlobsSpec& spec, std::string_view name, double earlier) {
    double most = earlier + static_cast<double>(spec.blobs.size());
    if (most > kMostBlobs)
        throw UserError(fmt::format("{}.blob: {:.0f} blobs with those of earlier media; allowed are {:.0f}", name, most,
                                    kMostBlobs));
    for (std::size_t m = 0; m < spec.sources.size(); ++m) {
        const BlobSourceSpec& s = spec.sources[m];
        if (s.rate == 0) continue;
        most += std::ceil(s.rate * s.lifetime) + 1;
        if (most > kMostBlobs)
            throw UserError(fmt::format(
                "{}.source.{}.rate = {:g} 1/s with lifetime = {:g} s keeps too many blobs alive, {:.0f} with "
                "those before it; allowed are {:.0f}: lower rate or lifetime",
                name, m, s.rate, s.lifetime, most, kMostBlobs));
    }
    return most - earlier;
}

/// 0 to 1 without a kink.
double ease(double s) {
    s = std::clamp(s, 0.0, 1.0);
    return s * s * (3 - 2 * s);
}

/// The last i that satisfies a condition which holds for all i up to there; guess: near it.
template <class Condition>
std::int64_t last_that(double guess, Condition&& holds) {
    auto i = static_cast<std::int64_t>(guess);
    while (holds(i + 1)) ++i;
    while (!holds(i)) --i;
    return i;
}

}  // namespace

double BlobCloud::Source::birth_time(std::int64_t i) const {
    return (static_cast<double>(i) + stream.uniform(2 * static_cast<std::uint64_t>(i))) / spec.rate;
}

dvec3 BlobCloud::Source::birth_place(std::int64_t i) const {
    if (!spec.to) return spec.from;
    return spec.from + (*spec.to - spec.from) * stream.uniform(2 * static_cast<std::uint64_t>(i) + 1);
}

BlobCloud::Range BlobCloud::Source::born(double after, double until) const {
    const auto last_until = [&](double t) {
        return last_that(std::floor(t * spec.rate), [&](std::int64_t i) { return birth_time(i) <= t; });
    };
    return {last_until(after) + 1, last_until(until)};
}

BlobCloud::BlobCloud(const BlobsSpec& spec, const IndexLaw& law, std::string_view name, double earlier)
    : name_(name), law_(law) {
    require_all(spec, name);
    most_ = count(spec, name, earlier);
    explicit_.reserve(spec.blobs.size());
    for (const BlobSpec& blob : spec.blobs)
        explicit_.push_back({blob.center, blob.sigma, law.above_ambient(blob.temperature)});
    double longest = 0;
    for (std::size_t m = 0; m < spec.sources.size(); ++m) {
        if (spec.sources[m].rate == 0) continue;
        sources_.push_back({spec.sources[m], RandomStream(spec.seed, "births", m)});
        longest = std::max(longest, spec.sources[m].lifetime);
    }
    if (!spec.wind || sources_.empty()) return;
    rise_ = spec.wind->rise;
    if (spec.wind->rms < kCalm) return;
    wind_ = std::make_unique<const Wind>(*spec.wind, longest);
    const double fitting = kCarriedBytes / (most_ * sizeof(dvec3));
    recent_ = std::make_unique<const BoundedCache<Carried>>(
        static_cast<std::size_t>(std::clamp(fitting, 1.0, static_cast<double>(kMostCarriedKept))));
}

std::vector<BlobHome> BlobCloud::homes() const {
    std::vector<BlobHome> homes;
    homes.reserve(explicit_.size() + sources_.size());
    for (const Blob& blob : explicit_) homes.push_back({blob, 0, 1});
    for (const Source& source : sources_) {
        const BlobSourceSpec& s = source.spec;
        const double sigma = std::sqrt(s.sigma * s.sigma + s.growth * s.lifetime);
        const dvec3 along = 0.5 * (s.to.value_or(s.from) - s.from), risen = 0.5 * s.lifetime * rise_;
        const double blown = wind_ ? kFastestEddy * wind_->rms() * s.lifetime : 0;
        homes.push_back({{s.from + along + risen, sigma, law_.above_ambient(s.temperature)},
                         glm::length(along) + glm::length(risen) + blown,
                         std::ceil(s.rate * s.lifetime) + 1});
    }
    return homes;
}

Blob BlobCloud::living(const Source& source, double age, const dvec3& center) const {
    const BlobSourceSpec& s = source.spec;
    const double sigma = std::sqrt(s.sigma * s.sigma + s.growth * age), thinner = s.sigma / sigma;
    const double heat = portable::exp(-s.cooling * age) * (thinner * thinner * thinner);
    const double T = law_.ambient_temperature + (s.temperature - law_.ambient_temperature) * heat;
    const double part = age / s.lifetime;
    const double presence = ease(part / kBirthPart) * ease((1 - part) / kFadePart);
    return {center, sigma, law_.above_ambient(T) * presence};
}

std::vector<Blob> BlobCloud::at(double t) const {
    if (!sources_.empty() && !(std::abs(t) <= kLatestTime))
        throw FrameError(
            fmt::format("{}: t = {:g} s is beyond the ±{:g} s for which sources of blobs are worked out; set "
                        "time.first_frame nearer to the frames, or a higher time.fps",
                        name_, t, kLatestTime));
    std::vector<Range> range;
    for (const Source& source : sources_) range.push_back(source.born(t - source.spec.lifetime, t));
    const std::vector<std::vector<dvec3>> place = places(t, range);
    std::vector<Blob> blobs = explicit_;
    for (std::size_t m = 0; m < sources_.size(); ++m)
        for (std::size_t j = 0; j < range[m].size(); ++j) {
            const double age = t - sources_[m].birth_time(range[m].first + static_cast<std::int64_t>(j));
            blobs.push_back(living(sources_[m], age, place[m][j]));
        }
    return blobs;
}

std::vector<std::vector<dvec3>> BlobCloud::places(double t, const std::vector<Range>& range) const {
    const double steps = wind_ ? t / wind_->step() : 0, k = std::floor(steps);
    std::shared_ptr<const Carried> begin;
    std::vector<WindInterval> interval;
    if (wind_) {
        begin = carried(static_cast<std::int64_t>(k));
        interval = wind_->intervals(static_cast<std::int64_t>(k), 1);
    }
    std::vector<std::vector<dvec3>> place(sources_.size());
    for (std::size_t m = 0; m < sources_.size(); ++m) {
        const Source& source = sources_[m];
        place[m].resize(range[m].size());
        tbb::parallel_for(std::size_t{0}, place[m].size(), [&](std::size_t j) {
            const std::int64_t i = range[m].first + static_cast<std::int64_t>(j);
            const double birth = source.birth_time(i);
            if (!wind_) {
                place[m][j] = source.birth_place(i) + rise_ * (t - birth);
                return;
            }
            const double birth_steps = birth / wind_->step();
            place[m][j] = birth_steps < k
                              ? interval[0].carry(begin->place[m][static_cast<std::size_t>(i - begin->range[m].first)],
                                                  0, steps - k)
                              : interval[0].carry(source.birth_place(i), birth_steps - k, steps - k);
        });
    }
    return place;
}

BlobCloud::Range BlobCloud::carried_range(const Source& source, std::int64_t k) const {
    const double step = wind_->step(), t = static_cast<double>(k) * step;
    // Rounding of k Δ must not lose what is still alive anywhere in the interval that begins there.
    const double early = t - source.spec.lifetime - 4 * std::numeric_limits<double>::epsilon() * std::abs(t);
    Range range = source.born(early, t);
    range.last = last_that(static_cast<double>(range.last),
                           [&](std::int64_t i) { return source.birth_time(i) / step < static_cast<double>(k); });
    return range;
}

void BlobCloud::advance(const Source& source, const WindInterval& interval, double k, const Range& range,
                        std::vector<dvec3>& place) const {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, place.size(), kBlobsAtOnce), [&](const auto& part) {
        for (std::size_t j = part.begin(); j < part.end(); ++j) {
            const std::int64_t i = range.first + static_cast<std::int64_t>(j);
            const double birth = source.birth_time(i) / wind_->step();
            if (birth >= k + 1) return;
            place[j] = birth < k ? interval.carry(place[j], 0, 1) : interval.carry(source.birth_place(i), birth - k, 1);
        }
    });
}

std::shared_ptr<const BlobCloud::Carried> BlobCloud::carried(std::int64_t k) const {
    auto now = std::make_shared<Carried>();
    const double step = wind_->step();
    std::int64_t first = k;
    for (const Source& source : sources_) {
        const Range range = carried_range(source, k);
        now->range.push_back(range);
        now->place.emplace_back(range.size());
        if (range.size() > 0)
            first = std::min(first, static_cast<std::int64_t>(std::floor(source.birth_time(range.first) / step)));
    }
    if (const auto found = recent_->latest(first, k); found.value) {
        if (found.key == k) return found.value;
        first = found.key;
        for (std::size_t m = 0; m < sources_.size(); ++m) {
            const Range& then = found.value->range[m];
            for (std::int64_t i = now->range[m].first; i <= std::min(then.last, now->range[m].last); ++i)
                now->place[m][static_cast<std::size_t>(i - now->range[m].first)] =
                    found.value->place[m][static_cast<std::size_t>(i - then.first)];
        }
    }
    for (std::int64_t begin = first; begin < k; begin += kIntervalsAtOnce) {
        const auto steps = static_cast<int>(std::min<std::int64_t>(kIntervalsAtOnce, k - begin));
        const std::vector<WindInterval> intervals = wind_->intervals(begin, steps);
        for (int s = 0; s < steps; ++s)
            for (std::size_t m = 0; m < sources_.size(); ++m)
                advance(sources_[m], intervals[static_cast<std::size_t>(s)], static_cast<double>(begin + s),
                        now->range[m], now->place[m]);
    }
    recent_->keep(k, now);
    return now;
}

}  // namespace eikonal
