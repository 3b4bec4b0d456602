#include "reference/trace/surface_search.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

namespace eikonal::reference {
namespace {

/// The most halvings of a chord that cuts what its curve passes. After them the chord's hit is exact enough.
constexpr int kMostHalvings = 12;

/// The part of a straight step at which its line meets a surface.
double straight_part(const Step& step, const Hit& hit) {
    return glm::dot(hit.point - step.from.x, step.from.p) / (step.h * glm::dot(step.from.p, step.from.p));
}

}  // namespace

/// How much longer [m] the chord may become along a piece of this curvature [1/m]. Two bounds of its deviation from the
/// curve are known, for a chord that becomes longer by d:
///     (β + κd)(l + d)/4,      max κ (l + d)²/8
/// The deviation may be at most angle times the distance at the chord's middle, plus width. The larger root counts.
double SurfaceSearch::room(double curvature) const {
    const double at_start = distance_ - chord_length_, angle = deviation_.angle;
    const double largest = std::max(chord_curvature_, curvature), here = angle * at_start + deviation_.width;
    double steady = 0;
    if (largest > 0 && std::isfinite(largest))
        steady =
            (0.5 * angle + std::sqrt(0.25 * angle * angle + 0.5 * largest * here)) / (0.25 * largest) - chord_length_;
    const double b = chord_bend_ + curvature * chord_length_ - 2 * angle;
    const double c = chord_bend_ * chord_length_ - 2 * angle * chord_length_ - 4 * here;
    if (c > 0) return std::max(0.0, steady);
    if (curvature == 0) return b > 0 ? std::max(steady, -c / b) : std::numeric_limits<double>::infinity();
    const double root = std::sqrt(b * b - 4 * curvature * c);
    return std::max(steady, b > 0 ? -2 * c / (b + root) : (root - b) / (2 * curvature));
}

std::optional<SurfaceSearch::Met> SurfaceSearch::add(const Step& step, double length, double bend, double kink) {
    if (!geometry_) return {};
    pieces_[static_cast<std::size_t>(count_++)].emplace(step);
    const double curvature = length > 0 ? bend / length : 0;
    double done = 0;
    if (count_ == 1 && chord_start_ == 0) chord_from_ = step.from.x;
    if (chord_length_ > 0 && kink > 0) {
        chord_bend_ += kink;
        chord_curvature_ = std::numeric_limits<double>::infinity();
    }
    while (true) {
        const double more = std::max(room(curvature), chord_length_ > 0 ? 0.0 : length / kMostChords);
        if (more >= (length - done) * (1 - 1e-12)) break;
        done += more;
        chord_length_ += more;
        distance_ += more;
        if (auto met = close(count_ - 1 + done / length)) return met;
    }
    chord_bend_ += curvature * (length - done);
    chord_curvature_ = std::max(chord_curvature_, curvature);
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
    const dvec3 end = position(until);
    if (chord_length_ > 0)
        if (auto met = test({chord_start_, until, chord_from_, end}, distance_ - chord_length_ - start_, 0)) return met;
    // Drop the pieces that no chord needs any more.
    const int last = std::min(static_cast<int>(until), count_);
    std::move(pieces_.begin() + last, pieces_.begin() + count_, pieces_.begin());
    count_ -= last;
    chord_start_ = until - last;
    chord_from_ = end;
    chord_length_ = chord_bend_ = chord_curvature_ = 0;
    return {};
}

int SurfaceSearch::piece_of(double place) const {
    return std::clamp(static_cast<int>(place), 0, count_ - 1);
}

dvec3 SurfaceSearch::position(double place) const {
    const int index = piece_of(place);
    return piece(index).position(place - index);
}

/// The place on the curve that is `way` [m] beyond `from`, if every piece ran evenly along its chord.
double SurfaceSearch::place_after(double from, double until, double way) const {
    for (double start = from;;) {
        const double end = std::min(until, piece_of(start) + 1.0),
                     length = glm::length(position(end) - position(start));
        if (way <= length || !(end < until))
            return start + (length > 0 ? std::clamp(way / length, 0.0, 1.0) : 0.0) * (end - start);
        way -= length;
        start = end;
    }
}

/// travelled: length of path from the ray's start to the chord's. The chord may begin earlier by half of it.
std::optional<SurfaceSearch::Met> SurfaceSearch::test(const Chord& chord, double travelled, int depth) const {
    const auto& [from, until, a, b] = chord;
    const double length = glm::length(b - a);
    if (!(length > 0)) return {};
    const double before = start_ + travelled, back = std::min(kFloatSlack * before, 0.5 * travelled);
    const dvec3 d = (b - a) / length;
    const auto hit = geometry_->intersect(a - back * d, d, 0, back + length + kFloatSlack * (before + length));
    if (!hit) return {};
    const double guess = place_after(from, until, std::max(0.0, hit->t - back));
    const int index = piece_of(guess);
    const Step& step = piece(index);
    // A straight piece is its own chord.
    if (step.straight && from >= index && until <= index + 1)
        return Met{*hit, step, std::clamp(straight_part(step, *hit), 0.0, 1.0)};
    if (depth == kMostHalvings) return Met{*hit, step, guess - index};
    if (auto met = refine(from, until, guess, back, before + hit->t, *hit)) return met;
    const double middle = 0.5 * (from + until);
    const dvec3 between = position(middle);
    if (auto met = test({from, middle, a, between}, travelled, depth + 1)) return met;
    return test({middle, until, between, b}, travelled + glm::length(between - a), depth + 1);
}

/// The place where the curve passes through the tangent plane at `hit`, by Newton's method from `guess`, or else by the
/// Illinois form of regula falsi.
double SurfaceSearch::plane_root(double from, double until, double guess, const Hit& hit) const {
    int current = -1;
    double start = 0;
    std::array<double, 5> along{};
    const auto height = [&](double place) {
        if (const int index = piece_of(place); index != current) {
            current = index;
            const Step& step = piece(current);
            start = glm::dot(step.from.x - hit.point, hit.normal);
            along = step.along(hit.normal);
        }
        const double t = place - current;
        return start + t * (along[0] + t * (along[1] + t * (along[2] + t * (along[3] + t * along[4]))));
    };
    // Pieces may have any lengths. First find the piece that passes through the plane, near the guess if several do.
    double a = from, b = until, ga = 0, gb = 0, off = std::numeric_limits<double>::infinity();
    const double g_from = height(from);
    double start_of = from, g_start = g_from;
    while (start_of < until) {
        const double end = std::min(until, piece_of(start_of) + 1.0), g_end = height(end);
        const double away = std::max({0.0, start_of - guess, guess - end});
        if ((g_start > 0) != (g_end > 0) && away < off) a = start_of, b = end, ga = g_start, gb = g_end, off = away;
        start_of = end;
        g_start = g_end;
    }
    if (!std::isfinite(off)) return std::abs(g_from) < std::abs(g_start) ? from : until;
    const double rounding = 1e-15 * (std::abs(ga) + std::abs(gb));
    for (int i = 0; i < 4 && guess >= a && guess <= b; ++i) {
        const double g = height(guess), t = guess - current;
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

/// back: how far before the chord the surface may lie. distance: about the distance of the hit from the camera.
std::optional<SurfaceSearch::Met> SurfaceSearch::refine(double from, double until, double guess, double back,
                                                        double distance, const Hit& chord_hit) const {
    const dvec3 start = position(from);
    Hit hit = chord_hit;
    double reach = 0;
    for (int i = 0; i < 6; ++i) {
        const double place = plane_root(from, until, guess, hit);
        guess = place;
        const int index = piece_of(place);
        const Step& step = piece(index);
        const dvec3 x = step.position(place - index), d = glm::normalize(step.direction(place - index));
        // Test again along the tangent, from before the point to beyond it by all possible errors.
        if (i == 0) reach = 2 * glm::length(x - hit.point) + kFloatSlack * (1 + 4 * distance);
        const double before = std::min(reach, glm::length(x - start) + back);
        const auto again = geometry_->intersect(x - before * d, d, 0, before + reach);
        if (!again || again->object != chord_hit.object) return {};
        hit = *again;
        // The tangent of a straight piece is that piece.
        if (const double part = step.straight ? straight_part(step, hit) : -1; part >= 0 && part <= 1)
            return Met{hit, step, part};
        const double off = std::abs(hit.t - before);
        // A tangent of length `off` deviates from the curve by the square of `off`.
        if (off <= 1e-12 * (1 + distance)) return Met{hit, step, place - index};
    }
    return {};
}

}  // namespace eikonal::reference
