/// Mirages: how a heated or cooled plane in front of a camera displaces what lies behind, by pixel and depth, exactly
/// and not to first order.
///
/// Rays. The straight ray of a pixel leaves with w, the sine of its elevation over the plane, and SurfaceRay bends it.
/// Where the bent ray is at axial depth z, it is δ above the straight ray over the same spot of the plane. The object
/// there appears displaced by
///     d(p, z) = δ/z · f_px (n·right - s_x n·forward, -(n·up - s_y n·forward) · pixel aspect),
/// exactly; s is the pixel's slope, n the plane's normal. (In an orthographic view δ stands for δ/z, and s = 0.) A ray
/// that meets the plane ends there, and d keeps its value beyond that depth. Over a hot plane, all rays below the
/// critical angle pass on and show what lies behind, as a mirror would. Over a cold plane, rays from behind the horizon
/// come down to the camera. The plane may be tilted.
///
/// Ground. The plane is better known than any depth buffer, whose facets are metres long near the horizon. A pixel is
/// *ground* if its depth lies on the plane or below it, within kGroundTolerance and half a pixel. Ground stands in no
/// ray's way: rays end on the plane itself (mirage_meeting.h). All that stands up from the plane is an object, hills
/// included.
///
/// Several surfaces. Each bends rays as if it were alone, and displacements add. This is right where at most one of
/// them bends a ray much, as road and wall do. Surfaces that are about parallel bend the same rays one after the other,
/// and are refused.
///
/// Accuracy: kMirageError [px] for rays that move by more than kMirageThreshold. Smaller displacements count as none.
/// Theory: PHYSICS.md#mirage.
#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include "noise/medium/optics.h"
#include "noise/surface/surface_spec.h"
#include "warp/displace/grid/ray_frame.h"
#include "warp/displace/grid/shift.h"
#include "warp/displace/media/surface/surface_ray.h"
#include "warp/pixels/linear_image.h"

namespace eikonal {

/// [px], within the display window.
inline constexpr double kMirageThreshold = 0.001, kMirageError = 0.005;
/// Greatest height over the plane of what counts as ground, besides half a pixel [m].
inline constexpr double kGroundTolerance = 0.005;
/// Least |cosine| between the normals of two surfaces that do not add.
inline constexpr double kParallelSurfaces = 0.5;

/// Another start of a pixel's ray.
struct Launch {
    double lift = 0;  ///< higher over the plane [m]
    double tilt = 0;  ///< steeper: metres of height by metre of axial depth
};

/// One surface for one camera. Immutable and thread-safe. A function of camera and medium alone.
class Mirage {
  public:
    /// spec.normal: of unit length. farthest: largest axial depth that will be asked for [m]. medium: its name in
    /// messages, for example "medium.2".
    /// UserError: the camera is not above the surface; the index is not positive everywhere.
    Mirage(const SurfaceSpec& spec, const IndexLaw& law, double exaggeration, RayEquation equation,
           const Camera& camera, double farthest, const std::string& medium);

    /// Whether any pixel of the window may move by kMirageThreshold.
    bool touches(const PixelWindow& window) const;
    /// Bound of |d| over the window's pixels and all depths up to `farthest` [px].
    double largest_shift(const PixelWindow& window) const;
    /// Whether depth z at a pixel is ground.
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
        double end = 0;                   ///< axial depth where it meets the plane; infinite if it never does
        double shift_x = 0, shift_y = 0;  ///< d for δ = 1 m at z = 1 m
        Launch launch;
    };
    /// Bends the ray of a pixel. False if the pixel moves by less than kMirageThreshold at every depth; `out` is then
    /// left as it was.
    bool ray(int x, int y, PixelRay& out, const Launch& launch = {}) const;
    /// δ at axial depth z, counted from the pixel's own straight ray [m]. Beyond the ray's end it is that of the end.
    double rise(const PixelRay& pixel, double z) const {
        const double way = z < pixel.end ? z : pixel.end;
        return pixel.ray.rise_where(z, pixel.along, pixel.across) + pixel.launch.lift + pixel.launch.tilt * way;
    }
    /// d at axial depth z > 0.
    Shift shift(const PixelRay& pixel, double z) const {
        const double scale = rise(pixel, z) / (perspective_ ? (z < pixel.end ? z : pixel.end) : 1);
        return {static_cast<float>(scale * pixel.shift_x), static_cast<float>(scale * pixel.shift_y)};
    }
    /// Axial depth where a pixel's ray turns upwards over the plane, or meets it; 0 if it does neither.
    double anchor(const PixelRay& pixel) const;
    /// How the height h of a pixel's bent ray depends on the ray's start: A = ∂h/∂lift and B = ∂h/∂tilt [m] at the
    /// axial depths z, in ascending order. Beyond the ray's end they are those of the end.
    void response(int x, int y, const PixelRay& pixel, std::span<const double> z, std::span<double> A,
                  std::span<double> B) const;
    /// d at z = 1 m of a bend by one metre: across the plane, and along the plane at right angles to the pixel's ray.
    struct Axes {
        dvec2 across, along;
    };
    Axes axes(int x, int y) const;
    /// Sine of the elevation of a pixel's straight ray over the plane.
    double elevation(int x, int y) const;
    /// The same of a quarter of a pixel.
    double quarter_pixel() const { return 0.25 / px_; }
    /// Direction in which rays are bent: 1 for up, from a hot surface, -1 for down, to a cold one.
    double bend_sign() const { return optics_.sign; }
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
    std::array<double, 3> climb_;  ///< height that a pixel's ray gains by metre of depth (orthographic: its height), as
                                   ///< an affine function of 1, x, y
    double half_pixel_;            ///< change of that over half a pixel
    double px_;                    ///< pixels of d by unit of slope, at most
    std::vector<std::array<double, 2>> scan_;  ///< pairs: w, ascending, and the largest δ/σ up to `farthest`
    double low_ = 0, high_ = 0;                ///< outside of these w no pixel moves
};

/// UserError if two of these surfaces do not add. mirages: of one camera. names: theirs in messages.
void check_surfaces(std::span<const Mirage> mirages, std::span<const std::string> names);

}  // namespace eikonal
