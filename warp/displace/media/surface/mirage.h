/// Mirages: a heated or cooled plane in front of a camera, as a displacement by depth that is exact and not first
/// order.
///
/// A pixel's straight ray leaves with w, the sine of its elevation over the plane; SurfaceRay bends it. Where the bent
/// ray crosses axial depth z it is δ above the straight ray over the same spot of the plane, and the object there shows
/// at
///     d(p, z) = δ/z · f_px (n·right - s_x n·forward, -(n·up - s_y n·forward) · pixel aspect)
/// from the pixel, exactly (s the pixel's slope, n the plane's normal; orthographic: δ for δ/z, and s = 0). A ray that
/// meets the plane ends there: beyond that depth, d stays. Hence over a hot plane all rays below the critical angle
/// pass on and show what lies behind, as in a mirror; over a cold one rays from behind the horizon come down to the
/// camera. The plane itself may be tilted.
///
/// The plane is better known than any depth buffer, whose facets are metres long near the horizon. A pixel whose depth
/// lies on the plane or below, within kGroundTolerance and half a pixel, is *ground*: it stands in no ray's way, and
/// rays end on the plane itself (meet.h). What stands up from the plane, hills included, is an object as ever.
///
/// Several surfaces add, each as if it were alone: right where each ray is bent much by one at most, as over road and
/// wall. Surfaces about parallel to each other bend the same rays one after the other, and are refused.
///
/// Accuracy: kMirageError [px] for rays that move by more than kMirageThreshold; less counts as nothing.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "warp/displace/grid/ray_frame.h"
#include "warp/displace/grid/shift.h"
#include "warp/displace/media/surface/surface_ray.h"
#include "warp/pixels/linear_image.h"

namespace eikonal {

/// [px] within the display window.
inline constexpr double kMirageThreshold = 0.001, kMirageError = 0.005;
/// A depth within this height of the plane, and half a pixel's, is the plane's [m].
inline constexpr double kGroundTolerance = 0.005;
/// |cosine| between the normals of two surfaces from which they do not add.
inline constexpr double kParallelSurfaces = 0.5;

/// Another start of a pixel's ray: higher over the plane [m], and steeper, in metres a metre of axial depth.
struct Launch {
    double lift = 0, tilt = 0;
};

/// One surface for one camera. Immutable, thread-safe. A function of camera and medium alone.
class Mirage {
  public:
    /// spec.normal: of unit length. farthest: axial depth that will be asked for [m]. medium: what messages call it,
    /// as "medium.2".
    /// UserError: the camera is not above the surface; the index is not positive everywhere.
    Mirage(const SurfaceSpec& spec, const IndexLaw& law, double exaggeration, RayEquation equation,
           const Camera& camera, double farthest, const std::string& medium);

    /// Whether any pixel of the window may move by kMirageThreshold.
    bool touches(const PixelWindow& window) const;
    /// Bound of |d| in pixels over the window's pixels and depths up to farthest.
    double largest_shift(const PixelWindow& window) const;
    /// Whether depth z at a pixel lies on the plane or below.
    bool on_ground(int x, int y, double z) const {
        const double climb = climb_[0] + climb_[1] * x + climb_[2] * y;
        return perspective_ ? H_ + z * climb <= kGroundTolerance + z * half_pixel_
                            : climb + z * lift_ <= kGroundTolerance + half_pixel_;
    }
    const dvec3& normal() const { return normal_; }

    /// One pixel's bent ray.
    struct PixelRay {
        SurfaceRay ray;
        double along = 1, across = 0;     ///< z = along σ + across (h - H)
        double end = 0;                   ///< axial depth where it meets the plane; infinite if never
        double shift_x = 0, shift_y = 0;  ///< d of δ = 1 at z = 1
        Launch launch;
    };
    /// False if the pixel moves by less than kMirageThreshold at any depth; `out` is then untouched.
    bool ray(int x, int y, PixelRay& out, const Launch& launch = {}) const;
    /// δ at axial depth z, from the pixel's own straight ray [m]: that of its end beyond that.
    double rise(const PixelRay& pixel, double z) const {
        const double way = z < pixel.end ? z : pixel.end;
        return pixel.ray.rise_where(z, pixel.along, pixel.across) + pixel.launch.lift + pixel.launch.tilt * way;
    }
    Shift shift(const PixelRay& pixel, double z) const {
        const double scale = rise(pixel, z) / (perspective_ ? (z < pixel.end ? z : pixel.end) : 1);
        return {static_cast<float>(scale * pixel.shift_x), static_cast<float>(scale * pixel.shift_y)};
    }
    /// Axial depth where a pixel's ray turns round over the plane or meets it; 0 if it does neither.
    double anchor(const PixelRay& pixel) const;
    /// A = ∂h/∂H and B = ∂h/∂(slope by depth) of a pixel's bent ray, at axial depths z, ascending; up to its end.
    void response(int x, int y, const PixelRay& pixel, std::span<const double> z, std::span<double> A,
                  std::span<double> B) const;
    /// d at z = 1 of a bend of one metre across the plane, and along it at right angles to the pixel's ray.
    struct Axes {
        dvec2 across, along;
    };
    Axes axes(int x, int y) const;
    /// Sine of a pixel's elevation over the plane, and of a quarter of a pixel.
    double elevation(int x, int y) const;
    /// Which way it bends rays, and lifts or lowers where they are: 1 up, from a hot surface, -1 down, to a cold one.
    double way() const { return optics_.sign; }
    double quarter_pixel() const { return 0.25 / px_; }
    bool perspective() const { return perspective_; }

  private:
    struct Frame;
    Frame frame(double px, double py) const;
    std::array<double, 2> slopes(const PixelWindow& window) const;
    double farthest_stretch(const PixelWindow& window) const;
    double largest_rise(double w, double way) const;
    double largest_between(double low, double high) const;

    SurfaceOptics optics_;
    Camera camera_;
    dvec3 normal_;
    bool perspective_;
    double H_, farthest_;
    double right_, up_, lift_;     ///< the normal in camera axes
    std::array<double, 3> climb_;  ///< of a pixel's ray by metre of depth (orthographic: its height): affine in x, y
    double half_pixel_;            ///< of that, over half a pixel
    double px_;                    ///< pixels of d by unit of slope, at most
    std::vector<std::array<double, 2>> scan_;  ///< w ascending, largest δ/σ up to farthest
    double low_ = 0, high_ = 0;                ///< w outside which nothing moves
};

/// UserError if two of these surfaces do not add. `mirages` are of one camera; names: what messages call them.
void check_surfaces(std::span<const Mirage> mirages, std::span<const std::string> names);

}  // namespace eikonal
