#include "reference/surface_search.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

namespace eikonal::reference {
namespace {

/// Halvings of a chord that cuts what its curve passes; beyond, the chord's hit is as good.
constexpr int kMostHalvings = 12;

}  // namespace

/// How much longer [m] the chord may become along a piece of this curvature [1/m]: the root of
///     (β + κd)(l + d)/4 = angle (distance at the chord's middle) + width.
double SurfaceSearch::room(double curvature) const {
    const double at_start = distance_ - chord_length_;
    const double b = chord_bend_ + curvature * chord_length_ - 2 * deviation_.angle;
    const double c =
        chord_bend_ * chord_length_ - 2 * deviation_.angle * (2 * at_start + chord_length_) - 4 * deviation_.width;
    if (c > 0) return 0;
    if (curvature == 0) return b > 0 ? -c / b : std::numeric_limits<double>::infinity();
    const double root = std::sqrt(b * b - 4 * curvature * c);
    return b > 0 ? -2 * c / (b + root) : (root - b) / (2 * curvature);
}

std::optional<SurfaceSearch::Met> SurfaceSearch::add(const Step& step, double length, double kink) {
    if (!geometry_) return {};
    pieces_[static_cast<std::size_t>(count_++)] = step;
    const double bend = step.bend(), curvature = length > 0 ? bend / length : 0;
    double done = 0;
    if (chord_length_ > 0) chord_bend_ += kink;
    while (true) {
        const double more = std::max(room(curvature), chord_length_ > 0 ? 0.0 : length / kMostChords);
        if (more >= (length - done) * (1 - 1e-12)) break;
        done += more;
        chord_length_ += more;
        distance_ += more;
        if (auto met = close(count_ - 1 + done / length)) return met;
    }
    chord_bend_ += curvature * (length - done);
    chord_length_ += length - done;
    distance_ += length - done;
    if (count_ == kMostPieces) return close(count_);
    return {};
}

std::optional<SurfaceSearch::Met> SurfaceSearch::finish() {
    if (!geometry_ || count_ == 0) return {};
    return close(count_);
}

std::optional<SurfaceSearch::Met> SurfaceSearch::close(double until) {
    if (chord_length_ > 0)
        if (auto met = test(chord_start_, until, distance_ - chord_length_ - start_, 0)) return met;
    // Pieces that are done with go.
    const int last = std::min(static_cast<int>(until), count_);
    std::move(pieces_.begin() + last, pieces_.begin() + count_, pieces_.begin());
    count_ -= last;
    chord_start_ = until - last;
    chord_length_ = chord_bend_ = 0;
    return {};
}

int SurfaceSearch::piece_of(double place) const {
    return std::clamp(static_cast<int>(place), 0, count_ - 1);
}

dvec3 SurfaceSearch::position(double place) const {
    const int index = piece_of(place);
    return pieces_[static_cast<std::size_t>(index)].position(place - index);
}

/// travelled: from the ray's start to the chord's, where it may begin earlier by half of that.
std::optional<SurfaceSearch::Met> SurfaceSearch::test(double from, double until, double travelled, int depth) const {
    const dvec3 a = position(from), b = position(until);
    const double length = glm::length(b - a);
    if (!(length > 0)) return {};
    const double slack = kFloatSlack * distance_, back = std::min(slack, 0.5 * travelled);
    const dvec3 d = (b - a) / length;
    const auto hit = geometry_->intersect(a - back * d, d, 0, back + length + slack);
    if (!hit) return {};
    const double guess = from + std::clamp((hit->t - back) / length, 0.0, 1.0) * (until - from);
    const int index = piece_of(guess);
    const Step& piece = pieces_[static_cast<std::size_t>(index)];
    // A straight piece is its own chord.
    if ((piece.straight && from >= index && until <= index + 1) || depth == kMostHalvings)
        return Met{*hit, piece, guess - index};
    if (auto met = refine(from, until, guess, back, *hit)) return met;
    const double middle = 0.5 * (from + until);
    if (auto met = test(from, middle, travelled, depth + 1)) return met;
    return test(middle, until, travelled + 0.5 * length, depth + 1);
}

/// Place on the curve where it passes through the tangent plane at `hit`: from `guess` on by Newton's method, else by
/// Illinois' form of regula falsi.
double SurfaceSearch::plane_root(double from, double until, double guess, const Hit& hit) const {
    int piece = -1;
    double start = 0;
    std::array<double, 5> along{};
    const auto height = [&](double place) {
        if (const int index = piece_of(place); index != piece) {
            piece = index;
            const Step& step = pieces_[static_cast<std::size_t>(piece)];
            start = glm::dot(step.from.x - hit.point, hit.normal);
            along = step.along(hit.normal);
        }
        const double t = place - piece;
        return start + t * (along[0] + t * (along[1] + t * (along[2] + t * (along[3] + t * along[4]))));
    };
    double a = from, b = until, ga = height(a), gb = height(b);
    if ((ga > 0) == (gb > 0)) return std::abs(ga) < std::abs(gb) ? a : b;
    const double rounding = 1e-15 * (std::abs(ga) + std::abs(gb));
    for (int i = 0; i < 4 && guess >= from && guess <= until; ++i) {
        const double g = height(guess), t = guess - piece;
        if (std::abs(g) <= rounding) return guess;
        guess -= g / (along[0] + t * (2 * along[1] + t * (3 * along[2] + t * (4 * along[3] + t * 5 * along[4]))));
    }
    int side = 0;
    for (int i = 0; i < 100; ++i) {
        const double c = (a * gb - b * ga) / (gb - ga);
        if (!(c > a && c < b)) break;
        const double gc = height(c);
        if (std::abs(gc) <= rounding) return c;
        if ((gc > 0) == (ga > 0)) {
            a = c, ga = gc;
            if (side == -1) gb *= 0.5;
            side = -1;
        } else {
            b = c, gb = gc;
            if (side == 1) ga *= 0.5;
            side = 1;
        }
        if (b - a <= 4e-16 * b) break;
    }
    return std::abs(ga) < std::abs(gb) ? a : b;
}

/// back: how far the surface may lie before the chord.
std::optional<SurfaceSearch::Met> SurfaceSearch::refine(double from, double until, double guess, double back,
                                                        const Hit& chord_hit) const {
    const dvec3 start = position(from);
    Hit hit = chord_hit;
    double reach = 0;
    for (int i = 0; i < 6; ++i) {
        const double place = plane_root(from, until, guess, hit);
        guess = place;
        const int index = piece_of(place);
        const Step& step = pieces_[static_cast<std::size_t>(index)];
        const dvec3 x = step.position(place - index), d = glm::normalize(step.direction(place - index));
        // Shot at again along the tangent, from before the point to beyond it by all that may be wrong.
        if (i == 0) reach = 2 * glm::length(x - hit.point) + kFloatSlack * (1 + 4 * distance_);
        const double before = std::min(reach, glm::length(x - start) + back);
        const auto again = geometry_->intersect(x - before * d, d, 0, before + reach);
        if (!again || again->object != chord_hit.object) return {};
        hit = *again;
        const double off = std::abs(hit.t - before);
        // A tangent as long as `off` leaves the curve by its square.
        if (off <= 1e-12 * (1 + distance_)) return Met{hit, step, place - index};
    }
    return {};
}

}  // namespace eikonal::reference
