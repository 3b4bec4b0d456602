#include "noise/air/air.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "noise/base/error.h"
#include "noise/medium/medium_spec.h"
#include "noise/medium/optics.h"

namespace eikonal {
namespace {

/// Largest change of the index for which the first order is used. Beyond it the first order is no approximation.
constexpr double kLargestFirstOrder = 0.5;
/// The sum's n - 1 is limited to this in magnitude.
constexpr double kLargestIndex = 1e100;

void add(IndexSample& a, const IndexSample& b, double weight) {
    a.n += weight * b.n;
    a.gradient += weight * b.gradient;
}
void add(IndexJet& a, const IndexJet& b, double weight) {
    a.n += weight * b.n;
    a.gradient += weight * b.gradient;
    a.hessian += weight * b.hessian;
}
void scale(IndexSample& a, double factor) {
    a.gradient *= factor;
}
void scale(IndexJet& a, double factor) {
    a.gradient *= factor;
    a.hessian *= factor;
}

}  // namespace

AirInstant::AirInstant(const OpticsSpec& optics, std::vector<AirPart> parts)
    : AirInstant(ForceLaw{optics.ray_equation, index_law(optics).ambient(), optics.exaggeration}, std::move(parts)) {}

AirInstant::AirInstant(const ForceLaw& law, std::vector<AirPart> parts) : law_(law) {
    for (AirPart& part : parts) (part.instant->has_index() ? indexed_ : forced_).push_back(std::move(part));
}

/// n and its derivatives. They are absolute, except that 1 is subtracted from n. The derivatives are 0 where n <= 0.
template <class Jet, class Take>
Jet AirInstant::sum(Take&& take) const {
    Jet total{};
    for (const AirPart& part : indexed_) add(total, take(*part.instant), part.weight);
    total.n = law_.ambient + law_.exaggeration * total.n;
    if (!(total.n > -1)) return Jet{std::max(total.n, -kLargestIndex)};
    scale(total, law_.exaggeration);
    return total;
}

IndexSample AirInstant::sample(const dvec3& x) const {
    return sum<IndexSample>([&](const MediumInstant& m) { return m.sample(x); });
}

IndexJet AirInstant::jet(const dvec3& x) const {
    return sum<IndexJet>([&](const MediumInstant& m) { return m.jet(x); });
}

template <class Ask>
double AirInstant::least(Ask&& ask) const {
    double result = kNever;
    for (const AirPart& part : indexed_) result = std::min(result, ask(*part.instant));
    for (const AirPart& part : forced_) result = std::min(result, ask(*part.instant));
    return result;
}

dvec3 AirInstant::force(const dvec3& x, const dvec3& p) const {
    return motion(x, p).force;
}

AirInstant::Motion AirInstant::motion(const dvec3& x, const dvec3& p) const {
    const IndexSample s = sample(x);
    Motion m{(law_.equation == RayEquation::Paper ? 0.5 : 1 + s.n) * s.gradient, law_.speed(s.n)};
    for (const AirPart& part : forced_) m.force += part.instant->force(x, p);
    return m;
}

ForceJet AirInstant::force_jet(const dvec3& x, const dvec3& p) const {
    const IndexJet s = jet(x);
    ForceJet result;
    if (law_.equation == RayEquation::Paper) {
        result.force = 0.5 * s.gradient;
        result.by_position = 0.5 * s.hessian;
    } else {
        result.force = (1 + s.n) * s.gradient;
        result.by_position = (1 + s.n) * s.hessian + glm::outerProduct(s.gradient, s.gradient);
    }
    for (const AirPart& part : forced_) {
        const ForceJet own = part.instant->force_jet(x, p);
        result.force += own.force;
        result.by_position += own.by_position;
        result.by_direction += own.by_direction;
    }
    return result;
}

double AirInstant::refractivity(const dvec3& x) const {
    return sample(x).n;
}

double AirInstant::speed(const dvec3& x) const {
    return law_.speed(refractivity(x));
}

double AirInstant::longest_step(const dvec3& x) const {
    return least([&](const MediumInstant& m) { return m.longest_step(x); });
}

double AirInstant::longest_step(const dvec3& x, const dvec3& d) const {
    return least([&](const MediumInstant& m) { return m.longest_step(x, d); });
}

double AirInstant::longest_stride(const dvec3& x, const dvec3& d, double turn) const {
    return least([&](const MediumInstant& m) { return m.longest_stride(x, d, turn); });
}

double AirInstant::clear_way(const dvec3& x, const dvec3& d) const {
    return least([&](const MediumInstant& m) { return m.clear_way(x, d); });
}

double AirInstant::way_to_edge(const dvec3& x, const dvec3& d) const {
    return least([&](const MediumInstant& m) { return m.way_to_edge(x, d); });
}

std::optional<StraightBend> AirInstant::straight_bend(const dvec3& x, const dvec3& d, double distance,
                                                      double turn) const {
    StraightBend sum;
    for (const auto* parts : {&indexed_, &forced_})
        for (const AirPart& part : *parts)
            if (!part.instant->add_bend(x, d, distance, turn, sum)) return {};
    if (!(sum.error < kLargestFirstOrder)) return {};
    return sum;
}

AirInstant::Interpolation AirInstant::interpolation(const dvec3& from, const dvec3& to) const {
    // Errors at distant places are independent, so their squares add up. ∫ (1 - s)² g² ds and ∫ g² ds are computed by
    // the midpoint rule.
    constexpr int kParts = 32;
    const double distance = glm::distance(from, to);
    double shift = 0, turn = 0;
    for (const AirPart& part : indexed_) {
        if (part.instant->interpolation_bend(from).error == 0) continue;
        for (int i = 0; i < kParts; ++i) {
            const double s = (i + 0.5) / kParts;
            const auto [error, g] = part.instant->interpolation_bend(from + s * (to - from));
            const double bend = part.weight * law_.strength() * error;
            const double square = bend * bend * g * g * distance / kParts;
            turn += square;
            shift += (1 - s) * (1 - s) * square;
        }
    }
    return {std::sqrt(shift) * distance, std::sqrt(turn)};
}

Air::Air(const std::vector<MediumSpec>& media, const OpticsSpec& optics, const AirSettings& settings)
    : law_{optics.ray_equation, index_law(optics).ambient(), optics.exaggeration} {
    ShotBudget budget{settings.memory_limit};
    for (std::size_t i = 0; i < media.size(); ++i) {
        const MediumSpec& spec = media[i];
        const MediumSetting setting{fmt::format("medium.{}", i), optics, settings.frame, settings.bend_error,
                                    settings.lattice_splines,    &budget};
        if (spec.has_absolute_index()) {
            if (media.size() > 1)
                throw UserError(
                    fmt::format("{}: a {} is the absolute index of all space and stands alone; remove it or the other "
                                "{}",
                                setting.name, spec.type(), media.size() == 2 ? "medium" : "media"));
            law_ = {optics.ray_equation, 0, 1};
        } else if (optics.exaggeration == 0) {
            notes_.emplace_back("left out, optics.exaggeration is zero");
            continue;
        }
        std::string still = spec.why_still(optics);
        if (still.empty()) {
            std::shared_ptr<const Medium> medium = spec.build(setting);
            still = medium->why_still();
            if (still.empty()) {
                notes_.push_back(medium->note());
                media_.push_back({i, std::move(medium)});
                continue;
            }
        }
        notes_.push_back("left out, " + still);
    }
}

AirInstant Air::at(double t) const {
    std::vector<AirPart> parts;
    for (const Part& part : media_) parts.push_back({part.medium->at(t, {.law = law_})});
    return AirInstant(law_, std::move(parts));
}

std::vector<std::string> Air::notes() const {
    std::vector<std::string> lines;
    for (std::size_t i = 0; i < notes_.size(); ++i) lines.push_back(fmt::format("medium.{}: {}", i, notes_[i]));
    return lines;
}

std::vector<std::string> Air::warnings() const {
    std::vector<std::string> lines;
    for (const Part& part : media_)
        if (const std::string warning = part.medium->warning(); !warning.empty())
            lines.push_back(fmt::format("medium.{}: {}", part.index, warning));
    return lines;
}

double Air::interpolation_error() const {
    double worst = 0;
    for (const Part& part : media_) worst = std::max(worst, part.medium->interpolation_error());
    return worst;
}

double Air::farthest_part(const dvec3& from) const {
    double farthest = 0;
    for (const Part& part : media_) farthest = std::max(farthest, part.medium->farthest_part(from));
    return farthest;
}

}  // namespace eikonal
