#include "warp/displace/media/surface/mirage.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "noise/base/error.h"
#include "noise/math/portable_math.h"
#include "noise/medium/optics.h"
#include "noise/surface/surface.h"
#include "noise/surface/surface_spec.h"

namespace eikonal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// The scan of δ/σ over w has nodes at 0 and from kLeastSine to 1 on either side, so many a decade. Between nodes the
/// value is at most kScanError times that of the larger of them.
constexpr double kLeastSine = 1e-8;
constexpr int kDecades = 8, kPerDecade = 40;
constexpr double kScanError = 1.15;
/// Rays that advance less than this along the view by metre of way do not graze the plane. They are not bent.
constexpr double kLeastAdvance = 1e-3;

}  // namespace

/// A pixel's straight ray, seen from the plane.
struct Mirage::Frame {
    dvec2 slope;    ///< of the pixel; 0 in an orthographic view
    double H, w;    ///< height of its start [m], sine of its elevation
    double along;   ///< PixelRay::along
    double length;  ///< way by metre of axial depth
};

Mirage::Frame Mirage::frame(double px, double py) const {
    const dvec2 s = camera_.slope(px, py);
    if (!perspective_) return {{0, 0}, H_ + s.x * right_ + s.y * up_, lift_, 1 - lift_ * lift_, 1};
    const double length = std::sqrt(1 + s.x * s.x + s.y * s.y);
    const double w = (lift_ + s.x * right_ + s.y * up_) / length;
    return {s, H_, w, 1 / length - lift_ * w, length};
}

Mirage::Mirage(const SurfaceSpec& spec, const IndexLaw& law, double exaggeration, RayEquation equation,
               const Camera& camera, double farthest, const std::string& medium)
    : optics_(spec, law, exaggeration, equation),
      camera_(camera),
      normal_(spec.normal),
      perspective_(camera.projection == Projection::Perspective),
      farthest_(farthest),
      right_(glm::dot(spec.normal, camera.right)),
      up_(glm::dot(spec.normal, camera.up)),
      lift_(glm::dot(spec.normal, camera.forward)) {
    const SurfaceIndex layer(spec, law);
    H_ = layer.height(camera.position);
    if (!(H_ > 0))
        throw UserError(fmt::format(
            "{}.origin: the camera at ({:g}, {:g}, {:g}) is {:g} m below this surface; it must be above it in "
            "every frame: lower the surface, or turn its normal towards the camera",
            medium, camera.position.x, camera.position.y, camera.position.z, 0.0 - H_));
    if (!(optics_.ambient > optics_.N * optics_.beta / (1 + optics_.beta)))
        throw UserError(
            fmt::format("{}: with an exaggeration of {:g} the refractive index at the surface is not positive; lower "
                        "optics.exaggeration or surface_temperature",
                        medium, exaggeration));
    const double scale_x = camera.f_px, scale_y = camera.f_px * camera.pixel_aspect;
    // The slope (or offset) of pixel (x, y)'s centre is that of (0, 0) + x/scale_x right - y/scale_y up.
    const dvec2 s0 = camera.slope(0.5, 0.5);
    climb_ = {(perspective_ ? lift_ : H_) + s0.x * right_ + s0.y * up_, right_ / scale_x, -up_ / scale_y};
    half_pixel_ = 0.5 * (std::abs(climb_[1]) + std::abs(climb_[2]));
    px_ = std::max(scale_x, scale_y);
    if (!optics_.bends()) return;
    if (!perspective_) {
        low_ = -1;
        high_ = 1;
        return;
    }
    const PixelWindow display{0, 0, static_cast<int>(std::min(2 * camera.center.x, 1e6)),
                              static_cast<int>(std::min(2 * camera.center.y, 1e6))};
    const double stretch = farthest_stretch(display);
    std::vector<double> sines{0, -1, 1};
    const double step = portable::exp(portable::log(10) / kPerDecade);
    double sine = kLeastSine;
    for (int i = 0; i < kDecades * kPerDecade; ++i, sine *= step) sines.insert(sines.end(), {-sine, sine});
    // δ jumps at the critical angle: one node on either side.
    const double critical = portable::sin(layer.critical_slope(H_, exaggeration, equation));
    if (critical > 0 && critical < 1) sines.insert(sines.end(), {-critical * (1 - 1e-9), -critical * (1 + 1e-9)});
    std::sort(sines.begin(), sines.end());
    for (const double w : sines) scan_.push_back({w, largest_rise(w, farthest * stretch)});
    const double least = kMirageThreshold / (kScanError * px_ * stretch * stretch);
    const auto moves = [least](const std::array<double, 2>& node) { return node[1] >= least; };
    const auto first = std::find_if(scan_.begin(), scan_.end(), moves);
    if (first == scan_.end()) return;
    const auto last = std::find_if(scan_.rbegin(), scan_.rend(), moves);
    low_ = (first == scan_.begin() ? *first : *(first - 1))[0];
    high_ = (last == scan_.rbegin() ? *last : *(last - 1))[0];
}

/// Greatest Frame::length of the window's rays.
double Mirage::farthest_stretch(const PixelWindow& window) const {
    double stretch = 1;
    for (const int i : {0, window.width})
        for (const int j : {0, window.height}) stretch = std::max(stretch, frame(window.x0 + i, window.y0 + j).length);
    return stretch;
}

/// Largest |δ|/σ up to a way. δ is convex or concave in σ, so |δ|/σ grows until the ray ends.
double Mirage::largest_rise(double w, double way) const {
    const SurfaceRay ray(optics_, H_, w);
    const double most = std::min(way, ray.hit());
    return std::abs(ray.rise(most)) / most;
}

/// Extrema of w over a window. They lie on its border, unless the window contains the normal's vanishing point.
std::array<double, 2> Mirage::slopes(const PixelWindow& window) const {
    const double x0 = window.x0, y0 = window.y0, x1 = x0 + window.width, y1 = y0 + window.height;
    double low = 1, high = -1;
    if (lift_ != 0) {
        const dvec2 pole = camera_.pixel({right_ / lift_, up_ / lift_});
        if (pole.x >= x0 && pole.x <= x1 && pole.y >= y0 && pole.y <= y1) (lift_ > 0 ? high : low) = lift_ > 0 ? 1 : -1;
    }
    const auto take = [&](double x, double y) {
        const double w = frame(x, y).w;
        low = std::min(low, w);
        high = std::max(high, w);
    };
    const auto side = [&](dvec2 from, dvec2 to) {
        take(from.x, from.y);
        // w = (a + b t)/√(c + 2 d t + e t²)
        const dvec2 s = camera_.slope(from.x, from.y), way = camera_.slope(to.x, to.y) - s;
        const double a = lift_ + s.x * right_ + s.y * up_, b = way.x * right_ + way.y * up_;
        const double c = 1 + glm::dot(s, s), d = glm::dot(s, way), e = glm::dot(way, way);
        const double below = b * d - a * e, t = below != 0 ? (a * d - b * c) / below : 0;
        if (t > 0 && t < 1) take(from.x + t * (to.x - from.x), from.y + t * (to.y - from.y));
    };
    side({x0, y0}, {x1, y0});
    side({x1, y0}, {x1, y1});
    side({x1, y1}, {x0, y1});
    side({x0, y1}, {x0, y0});
    return {low, high};
}

bool Mirage::touches(const PixelWindow& window) const {
    if (!(high_ > low_)) return false;
    if (!perspective_) return largest_shift(window) >= kMirageThreshold;
    const auto [low, high] = slopes(window);
    return low <= high_ && high >= low_;
}

/// Largest value of the scan over w from low to high.
double Mirage::largest_between(double low, double high) const {
    double largest = 0;
    for (std::size_t i = 0; i < scan_.size(); ++i) {
        const bool reaches = i + 1 == scan_.size() || scan_[i + 1][0] >= low;
        if (reaches && (i == 0 || scan_[i - 1][0] <= high)) largest = std::max(largest, scan_[i][1]);
    }
    return largest;
}

double Mirage::largest_shift(const PixelWindow& window) const {
    if (!(high_ > low_)) return 0;
    if (perspective_) {
        const auto [low, high] = slopes(window);
        const double stretch = farthest_stretch(window);
        return kScanError * px_ * stretch * stretch * largest_between(std::max(low, low_), std::min(high, high_));
    }
    // All rays have one slope and different heights. The air changes the square of the slope by Q at most. Rays that it
    // cannot turn round go on to the plane, or away from it.
    double highest = 0;
    for (const int i : {0, window.width})
        for (const int j : {0, window.height}) highest = std::max(highest, frame(window.x0 + i, window.y0 + j).H);
    const double w = std::abs(lift_), ground = optics_.ambient - optics_.N * optics_.beta / (1 + optics_.beta);
    const double ratio = optics_.ambient / ground, least = std::min(ratio, 1 / ratio);
    const double Q = 1 / (least * least) - 1;
    double way = farthest_ / std::max(1 - w * w, kLeastAdvance), bend = w + std::sqrt(w * w + Q);
    if (const double rest = w * w - Q; rest > 0) {
        if (lift_ < 0) way = std::min(way, highest / std::sqrt(rest));
        bend = std::max(w - std::sqrt(rest), std::sqrt(w * w + Q) - w);
    }
    return highest > 0 ? kScanError * px_ * bend * way : 0;
}

bool Mirage::ray(int x, int y, PixelRay& out, const Launch& launch) const {
    const Frame f = frame(x + 0.5, y + 0.5);
    if (!(f.w >= low_ && f.w <= high_ && f.H > 0 && high_ > low_ && f.along > kLeastAdvance)) return false;
    const double H = f.H + launch.lift, w = f.w + launch.tilt * f.along;
    const bool starts = H > 0 && std::abs(w) <= 1;
    out.launch = starts ? launch : Launch{};
    out.ray = starts ? SurfaceRay(optics_, H, w) : SurfaceRay(optics_, f.H, f.w);
    out.along = f.along;
    out.across = lift_;
    out.end = f.along * out.ray.hit() - lift_ * f.H;
    if (!(out.end > 0)) out.end = kInfinity;
    out.shift_x = camera_.f_px * (right_ - lift_ * f.slope.x);
    out.shift_y = -camera_.f_px * camera_.pixel_aspect * (up_ - lift_ * f.slope.y);
    return true;
}

double Mirage::elevation(int x, int y) const {
    return frame(x + 0.5, y + 0.5).w;
}

double Mirage::anchor(const PixelRay& pixel) const {
    if (std::isfinite(pixel.end)) return pixel.end;
    const double way = pixel.ray.turn();
    return way > 0 ? std::max(0.0, pixel.along * way + pixel.across * pixel.ray.climb(way)) : 0;
}

void Mirage::response(int x, int y, const PixelRay& pixel, std::span<const double> z, std::span<double> A,
                      std::span<double> B) const {
    constexpr double kPartOfHeight = 1e-3;
    const double lift = kPartOfHeight * frame(x + 0.5, y + 0.5).H, tilt = quarter_pixel();
    const auto differences = [&](const Launch& step, double size, std::span<double> out) {
        PixelRay up, down;
        double width = 2 * size;
        if (!ray(x, y, up, step) || !ray(x, y, down, {-step.lift, -step.tilt})) return;
        // A ray on the other side of the critical angle ends elsewhere: a one-sided difference must do.
        if (std::isfinite(up.end) != std::isfinite(pixel.end)) up = pixel, width = size;
        if (std::isfinite(down.end) != std::isfinite(pixel.end)) down = pixel, width -= size;
        for (std::size_t k = 0; k < z.size(); ++k) {
            const double way = std::min(z[k], pixel.end);
            out[k] = width > 0 ? (rise(up, way) - rise(down, way)) / width : 0;
        }
    };
    differences({lift, 0}, lift, A);
    differences({0, tilt}, tilt, B);
}

Mirage::Axes Mirage::axes(int x, int y) const {
    const StraightRay ray = straight_ray(camera_, x + 0.5, y + 0.5);
    const dvec3 side = glm::cross(normal_, ray.direction);
    const double length = glm::length(side);
    return {image_shift(camera_, ray, normal_), length > 0 ? image_shift(camera_, ray, side / length) : dvec2(0, 0)};
}

void check_surfaces(std::span<const Mirage> mirages, std::span<const std::string> names) {
    for (std::size_t i = 0; i < mirages.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (const double cosine = glm::dot(mirages[i].normal(), mirages[j].normal());
                std::abs(cosine) > kParallelSurfaces)
                throw UserError(
                    fmt::format("{}: this surface and that of {} are within 60 degrees of parallel, where a ray is "
                                "bent by both and "
                                "their mirages do not add; keep one of them",
                                names[i], names[j]));
}

}  // namespace eikonal
