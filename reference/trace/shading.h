/// The light along a ray: surfaces, sun, sky light and background. Radiance is linear, and 1 is reference white.
///
/// Without [light] every surface shows its own colour, as if emissive. With [light], a sun of colour S shines along the
/// unit direction l (towards the sun), and a sky of uniform colour A surrounds the scene. S and A are what a white
/// surface shows if it faces the sun, or if it lies under the open sky alone. A matte surface of colour c shows
///
///     L = emission + c ( S max(0, n·l) V  +  mean over the cosine-weighted hemisphere of what it sees )
///
/// V is the visible part of the sun's disc, whose angular radius is the true one, kSunRadius. Each sample sends one ray
/// to the disc and one into the hemisphere. The latter brings A where it meets nothing. Where it meets a surface, it
/// brings the sunlight and the sky light A off that surface, without further rays (one bounce). The background picture
/// lights nothing.
///
/// Failures: UserError with the key of a texture that is missing or cannot be read.
/// Theory: PHYSICS.md#tracer.
#pragma once

#include "reference/trace/geometry.h"

namespace eikonal::reference {

/// Angular radius of the sun seen from the Earth [rad].
inline constexpr double kSunRadius = 0.00465;

/// The random numbers in [0, 1) of one sample: a point of the sun's disc and a direction of the sky.
struct LightSample {
    dvec2 sun, sky;
};

/// A picture in linear light, bilinear between pixel centres.
class Texture {
  public:
    /// FrameError if it cannot be read.
    explicit Texture(const std::filesystem::path& file);

    /// Colour at uv: u to the right, v up, one repeat in [0, 1]. wrap_v: repeat upwards too, else extend the last row.
    dvec3 at(dvec2 uv, bool wrap_v = true) const;

  private:
    int width_ = 0, height_ = 0;
    std::vector<float> rgb_;  ///< row 0 on top
};

class Shadowgraph;

class Shading {
  public:
    /// Reads every texture. Keeps references to both arguments.
    Shading(const Scene& scene, const Geometry& geometry);

    /// Radiance that leaves `hit` towards the ray's origin. sunlight: null for straight sunlight.
    dvec3 surface(const Hit& hit, const LightSample& sample, const Shadowgraph* sunlight = nullptr) const;

    /// Radiance of the background in a direction.
    dvec3 background(dvec3 direction) const;

  private:
    dvec3 albedo(const Hit& hit) const;
    dvec3 sunlight(const Hit& hit, dvec3 to_sun, const Shadowgraph* bent = nullptr) const;
    dvec3 skylight(const Hit& hit, dvec3 to_sun, dvec2 sample) const;
    dvec3 sun_direction(dvec2 sample) const;

    const Scene& scene_;
    const Geometry& geometry_;
    dvec3 to_sun_{0, 1, 0}, sun_right_{1, 0, 0},
        sun_up_{0, 0, 1};  ///< direction of its centre, and the disc's axes, kSunRadius long
    std::vector<Texture> textures_;
    std::vector<int> texture_of_material_;  ///< -1: none
    std::optional<Texture> sky_;
};

}  // namespace eikonal::reference
