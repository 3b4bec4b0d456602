/// What light comes along a ray: surfaces, sun, sky light, background. All radiance is linear; 1 is reference white.
///
/// Without [light] every surface shows its own colour (emissive). With it, a matte surface of colour c under a sun of
/// colour S along unit direction l (towards the sun) and a sky of uniform colour A shows
///
///     L = emission + c ( S max(0, n·l) V  +  mean over the cosine-weighted hemisphere of what it sees ),
///
/// S and A being what a white surface facing the sun, or under the open sky alone, shows. V is the visible part of the
/// sun's disc, of the true angular radius kSunRadius. Each sample sends one ray to the disc and one into the
/// hemisphere: this brings A where it meets nothing, else the sunlight and, without further rays, sky light A off what
/// it meets (one bounce). The background picture lights nothing.
///
/// Failures: UserError naming the key of a texture that is missing or cannot be read.
#pragma once

#include "reference/trace/geometry.h"

namespace eikonal::reference {

/// Angular radius of the sun seen from the Earth [rad].
inline constexpr double kSunRadius = 0.00465;

/// Two pairs of numbers in [0, 1) that choose the rays of one sample.
struct LightSample {
    dvec2 sun, sky;
};

/// A picture in linear light, bilinear between pixel centres.
class Texture {
  public:
    /// FrameError if it cannot be read.
    explicit Texture(const std::filesystem::path& file);

    /// u to the right, v up, one repeat is [0, 1]. wrap_v: repeats upwards too, else the last row goes on.
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

    /// Radiance that leaves `hit` towards where the ray came from. sunlight: bent on its way, or null for straight.
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
    dvec3 to_sun_{0, 1, 0}, sun_right_{1, 0, 0}, sun_up_{0, 0, 1};  ///< its centre; the disc's axes, kSunRadius long
    std::vector<Texture> textures_;
    std::vector<int> texture_of_material_;  ///< -1: none
    std::optional<Texture> sky_;
};

}  // namespace eikonal::reference
