#include "warp/displace/media/surface/surface_ray.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "noise/math/portable_math.h"
#include "noise/medium/optics.h"
#include "noise/surface/surface_spec.h"

namespace eikonal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kMostNewtonSteps = 40;
/// After a Newton step of this length the error is of the order of its square [e-folds].
constexpr double kNewtonStep = 1e-6;
/// So many e-folds above the plane, a double no longer tells the air from ambient air. A start that is fewer than the
/// least above the plane counts as on it.
constexpr double kMostEfolds = 500, kLeastEfolds = 1e-12;
/// A way is short if height and slope change by this much at most [e-folds]. Two terms of the ray's series then have an
/// error of the square of this, while the closed form would lose its digits to cancellation.
constexpr double kShortWay = 1e-4;
/// If w² and differences of the index are less than this, rays count as straight.
constexpr double kNoBend = 1e-30;

/// artanh(√z)/√z for z < 1, which is arctan(√-z)/√-z for z < 0. Halves the argument of artanh until it is small, then
/// takes the series.
double artanh_ratio(double z) {
    constexpr double kSeries = 0.02;
    double scale = 1;
    for (int i = 0; i < 64 && (z > kSeries || z < -kSeries); ++i) {
        const double half = 1 / (1 + std::sqrt(z < 1 ? 1 - z : 0));
        z *= half * half;
        scale *= 2 * half;
    }
    double sum = 1.0 / 19;
    for (int k = 8; k >= 0; --k) sum = sum * z + 1.0 / (2 * k + 1);
    return scale * sum;
}

/// tanh(√z)/√z for small z, which is tan(√-z)/√-z for z < 0.
double tanh_ratio(double z) {
    return 1 + z * (-1.0 / 3 + z * (2.0 / 15 + z * (-17.0 / 315 + z * (62.0 / 2835 - z * (1382.0 / 155925)))));
}

}  // namespace

SurfaceOptics::SurfaceOptics(const SurfaceSpec& spec, const IndexLaw& law, double exaggeration, RayEquation equation)
    : d0(spec.dropoff),
      beta((spec.surface_temperature - law.ambient_temperature) / law.ambient_temperature),
      N(exaggeration * law.ambient()),
      ambient(1 + law.ambient()),
      paper(equation == RayEquation::Paper),
      sign(beta < 0 ? -1 : 1),
      log_beta(beta != 0 ? portable::log(std::abs(beta)) : 0) {}

SurfaceRay::SurfaceRay(const SurfaceOptics& optics, double H, double w) : optics_(&optics), w_(w) {
    const double efolds = std::max(H / optics.d0, kLeastEfolds);
    const double e_H = portable::exp(-std::min(efolds, kMostEfolds));
    const double y_H = optics.beta * e_H;
    // n(h) - n(H) = -N_H (y - y_H)/(1 + y);  (1 + y)² q = -k (y - y_H)(a + b y)
    const double N_H = optics.N / (1 + y_H);
    const double n_H = optics.ambient - optics.N * y_H / (1 + y_H);
    const double a = optics.paper ? 1 : 2 * n_H + N_H * y_H, b = optics.paper ? 1 : 2 * n_H - N_H;
    const double k = N_H / (optics.paper ? n_H : n_H * n_H);
    hit_ = kInfinity;
    straight_ = w * w < kNoBend && std::abs(k * a * y_H) < kNoBend;
    if (straight_) return;
    A_ = w * w + k * a * y_H;
    B_ = optics.sign * (2 * w * w - k * (a - b * y_H));
    C_ = w * w - k * b;
    root_ = std::sqrt(std::abs(A_));
    set_series(y_H, a, b, k);

    const double v_H = 1 / std::abs(optics.beta) / e_H, y_0 = optics.beta;
    const double at_ground = w * w * (1 + y_0) * (1 + y_0) - k * (y_0 - y_H) * (a + b * y_0);
    const double tau = set_anchor(at_ground, v_H, std::abs(w) * (1 + y_H) * v_H);
    // ln v bends nowhere faster than at the anchor.
    const double y = 1 / v_anchor_;
    tolerance_ = kNewtonStep / std::sqrt(std::abs(A_) + y * (std::abs(B_) + y * std::abs(C_)));
    start_log_ = efolds - optics.log_beta;
    set_far_end();

    const double chi = start_chi(tau), x = tau / (v_anchor_ + p_anchor_ * tau);
    const double X = chi + optics.sign * 2 * x * artanh_ratio(C_ * x * x);
    const double side = w < 0 ? -1 : 1;
    start_chi_ = side * chi;
    start_X_ = side * X;
    end_X_ = turns_ || (w >= 0 && A_ >= 0) ? kInfinity : w < 0 ? 0 : 2 * top_X_;
    hit_ = optics.d0 * (end_X_ - start_X_);
}

/// The series of a short way: derivatives of h by σ/d0 at the start, from (h/d0)'' = ½ dq/d(h/d0) and so on, with
/// dy/d(h/d0) = -y.
void SurfaceRay::set_series(double y_H, double a, double b, double k) {
    const double T = 1 + y_H, g1 = -k * (2 * b - a + b * y_H), g = -k * (a + (2 * a - b) * y_H) + g1 * y_H;
    const double q1 = g / (T * T * T), q2 = g1 / (T * T * T) - 3 * g / (T * T * T * T);
    bend_ = -0.5 * y_H * q1;
    bend_slope_ = 0.5 * (y_H * q1 + y_H * y_H * q2) * w_;
    short_ = kShortWay / (std::abs(w_) + std::sqrt(std::abs(bend_)));
}

/// Chooses the anchor: the turning point or the plane. at_ground: (1 + y)²(w² + q) at the plane; v_H, p_H: v and
/// |dv/dχ| at the start. Gives τ = tanh(root χ/2)/root of the start.
double SurfaceRay::set_anchor(double at_ground, double v_H, double p_H) {
    const double v_ground = 1 / std::abs(optics_->beta);
    turns_ = at_ground <= 0 && A_ > 0;
    if (turns_) {
        const double D = std::sqrt(std::max(0.0, B_ * B_ - 4 * A_ * C_));
        v_anchor_ = std::max(v_ground, B_ < 0 ? (D - B_) / (2 * A_) : -2 * C_ / (D + B_));
        p_anchor_ = 0;
        return p_H / (A_ * v_H + A_ * v_anchor_ + B_);
    }
    v_anchor_ = v_ground;
    p_anchor_ = std::sqrt(std::max(0.0, at_ground)) * v_ground;
    return (v_H - v_ground) / (p_H + p_anchor_);
}

/// |χ| of the start.
double SurfaceRay::start_chi(double tau) const {
    const double square = A_ * v_anchor_ + B_, t = root_ * tau;
    if (!(A_ > 0 && t > 0.5)) return 2 * tau * artanh_ratio(A_ * tau * tau);
    // 2 artanh(t), from 1 - t² = (v_anchor + …)/v_H
    return (2 * portable::log(1 + t) + start_log_ -
            portable::log(v_anchor_ + 2 * p_anchor_ * tau + square * tau * tau)) /
           root_;
}

/// What rays tend to far above the anchor, or the highest point of a duct.
void SurfaceRay::set_far_end() {
    cut_ = kInfinity;
    if (A_ > 0) {
        const double x_far = 1 / (v_anchor_ * root_ + p_anchor_);
        all_ = 2 * x_far * artanh_ratio(C_ * x_far * x_far);
        log_far_ = portable::log(0.25 * (2 * v_anchor_ + 2 * p_anchor_ / root_ + B_ / A_));
        cut_ = kSurfaceRayCut / root_;
    } else if (A_ < 0) {
        const double D = A_ * v_anchor_ + (A_ * v_anchor_ + B_);
        const double s = std::sqrt(D * D - 4 * A_ * p_anchor_ * p_anchor_);
        const double tau_top = D < 0 ? 2 * p_anchor_ / (s - D) : (D + s) / (-2 * A_ * p_anchor_);
        top_chi_ = 2 * tau_top * artanh_ratio(A_ * tau_top * tau_top);
        top_X_ = at(top_chi_).X;
    }
}

SurfaceRay::State SurfaceRay::at(double chi) const {
    const double u2 = 0.25 * A_ * chi * chi;
    double tau, rest;  // 1 - A τ²
    if (u2 < 2.5e-4 && u2 > -2.5e-4) {
        tau = 0.5 * chi * tanh_ratio(u2);
        rest = 1 - A_ * tau * tau;
    } else if (A_ > 0) {
        const double q = portable::exp(-root_ * chi), inverse = 1 / (1 + q);
        tau = (1 - q) * inverse / root_;
        rest = 4 * q * inverse * inverse;
    } else {
        tau = portable::tan(0.5 * root_ * chi) / root_;
        rest = 1 - A_ * tau * tau;
    }
    const double numerator = v_anchor_ + tau * (2 * p_anchor_ + tau * (A_ * v_anchor_ + B_));
    const double x = tau / (v_anchor_ + p_anchor_ * tau);
    const double inverse_v = rest / numerator;
    return {chi + optics_->sign * 2 * x * artanh_ratio(C_ * x * x), 1 + optics_->sign * inverse_v,
            (p_anchor_ * (1 + A_ * tau * tau) + (2 * A_ * v_anchor_ + B_) * tau) / numerator, 1 / inverse_v};
}

SurfaceRay::State SurfaceRay::signed_at(double chi) const {
    if (A_ < 0 && chi > top_chi_) {
        const State s = at(std::max(0.0, 2 * top_chi_ - chi));
        return {2 * top_X_ - s.X, s.dX, -s.log_slope, s.v};
    }
    const State s = at(std::abs(chi));
    return chi < 0 ? State{-s.X, s.dX, -s.log_slope, s.v} : s;
}

double SurfaceRay::rise_of(double X, double log_v) const {
    return optics_->d0 * ((log_v - start_log_) - w_ * (X - start_X_));
}

double SurfaceRay::rise_where(double z, double along, double across) const {
    if (straight_ || start_chi_ > cut_) return 0;
    const double inverse = 1 / optics_->d0, way = z * inverse / (along + across * w_);
    if (way < short_ && way < end_X_ - start_X_) return optics_->d0 * way * way * (0.5 * bend_ + bend_slope_ / 6 * way);
    // along X + across ln v = target
    const double target = z * inverse + along * start_X_ + across * start_log_;
    if (const double log_ground = -optics_->log_beta; target >= along * end_X_ + across * log_ground)
        return rise_of(end_X_, log_ground);
    const double sign = optics_->sign;
    const double log_cut = log_far_ + kSurfaceRayCut;
    if (start_chi_ < -cut_ && target <= across * log_cut - along * (cut_ + sign * all_)) return 0;
    if (target >= along * (cut_ + sign * all_) + across * log_cut) {
        const double chi = (target - along * sign * all_ - across * log_far_) / (along + across * root_);
        return rise_of(chi + sign * all_, root_ * chi + log_far_);
    }
    // Newton's method, from where the straight ray would be. X is concave (hot) or convex (cold) in |χ|, and the start
    // lies on the side from which the steps run to the root.
    const double X = start_X_ + way;
    const double size = std::abs(X), near = size / (1 + sign / v_anchor_);
    double chi = A_ > 0 ? (sign > 0 ? std::max(near, size - all_) : std::min(near, size + all_)) : size;
    if (X < 0) chi = -chi;
    const double highest = A_ < 0 ? 2 * top_chi_ : end_X_ == 0 ? 0 : cut_;
    for (int i = 0;; ++i) {
        chi = std::clamp(chi, start_chi_, highest);
        const State s = signed_at(chi);
        const double log_v = across != 0 ? portable::log(s.v) : 0;
        const double step = (target - along * s.X - across * log_v) / (along * s.dX + across * s.log_slope);
        if (std::abs(step) < tolerance_ || i == kMostNewtonSteps)
            return rise_of(s.X + s.dX * step, (across != 0 ? log_v : portable::log(s.v)) + s.log_slope * step);
        chi += step;
    }
}

}  // namespace eikonal
