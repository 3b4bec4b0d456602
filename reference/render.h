/// Renders one frame of a scene with straight rays: the undistorted plate and the depth that the warp takes as input.
///
/// Output: colour R, G, B (linear, half) and A = 1, the mean over each pixel's square (box filter); Z (float), the
/// axial depth in metres of the surface at the pixel's *centre*, infinity where there is only background. So colour is
/// antialiased and depth never mixes two surfaces. Row 0 on top.
///
/// The same bytes for any number of threads: every sample is a pure function of scene, frame, pixel and its index.
/// Not finite radiance never leaves: it is limited to 0 … the largest half.
///
/// Failures: UserError for the scene (geometry.h, shading.h, camera.h), FrameError when a file cannot be written.
#pragma once

#include <functional>

#include "reference/shading.h"
#include "warp/scene/camera.h"

namespace eikonal::reference {

/// Rows of width * height pixels.
struct RenderedFrame {
    int width = 0, height = 0;
    std::vector<float> color;  ///< R G B A, interleaved
    std::vector<float> depth;  ///< axial [m]
};

class Renderer {
  public:
    /// Reads meshes and textures once for all frames. samples: a pixel, >= 1.
    Renderer(const Scene& scene, int samples);

    /// tile_done, if given, is called after each of tile_count() tiles, from any thread.
    RenderedFrame render(int frame, const std::function<void()>& tile_done = {}) const;
    int tile_count() const;

  private:
    struct Tile {
        int x0, y0, x1, y1;
    };
    void render_tile(const Camera& camera, int frame, const Tile& tile, RenderedFrame& into) const;

    Scene scene_;
    int width_, height_, samples_;
    CameraPath path_;
    Geometry geometry_;
    Shading shading_;
};

/// The straight ray of a pixel position: origin and direction. The direction is not of unit length but has axial
/// component 1, so that a distance along it is an axial depth.
struct CameraRay {
    dvec3 origin, direction;
};
CameraRay camera_ray(const Camera& camera, double px, double py);

/// Exact: ZIP. Compact, for small sample files: colour DWAA (slightly lossy), Z rounded to within kCompactDepthError.
enum class Storage { Exact, Compact };

/// Relative.
inline constexpr double kCompactDepthError = 0x1p-18;

/// Writes R, G, B, A (half) and Z (float) as one EXR. FrameError.
void write_frame(const std::filesystem::path& file, const RenderedFrame& frame, Storage storage);

}  // namespace eikonal::reference
