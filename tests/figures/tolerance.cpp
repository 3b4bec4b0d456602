// The cost of accuracy in the tracer, as CSV. For scenes of samples/ and each tolerance it gives the processor time of
// a ray and the largest error of its displacement, compared with the finest tolerance. Rebuilds
// reference/trace/tolerance.png with reference/trace/tolerance.gp (reference/README.md).
//
// The rays go through the centres of a grid of pixels, one after the other. Times are medians of kRuns runs. A ray that
// sees another object than at the finest tolerance, beside an edge, has no displacement to compare and is left out.
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <glm/geometric.hpp>

#include "reference/trace/render.h"
#include "warp/scene/background.h"

namespace eikonal::reference {
namespace {

constexpr int kAcross = 18, kRuns = 3;
constexpr double kFinest = 1e-8;

/// Rays of a grid of pixels' centres through one scene.
struct Grid {
    Scene scene;
    SceneAir air;
    AirInstant field;
    Camera camera;
    Geometry geometry;
    std::vector<CameraRay> rays;

    explicit Grid(Scene s)
        : scene(std::move(s)),
          air(scene, {}),
          field(air.at(scene.time.first_frame)),
          camera(air.path().reference()),
          geometry(scene, camera.position) {
        const auto [width, height] = scene.camera.resolution.value();
        for (int j = 0; j < kAcross; ++j)
            for (int i = 0; i < kAcross; ++i) {
                rays.push_back(camera_ray(camera, (i + 0.5) * width / kAcross, (j + 0.5) * height / kAcross));
                rays.back().direction = glm::normalize(rays.back().direction);
            }
    }
    std::vector<BentHit> follow(double tolerance) const {
        TraceSettings trace = air.trace_settings(camera);
        trace.sight = far_of_scene(scene);
        trace.tolerance_px = tolerance;
        std::vector<BentHit> ends;
        for (const CameraRay& ray : rays)
            ends.push_back(reference::trace(field, &geometry, ray.origin, ray.direction, trace));
        return ends;
    }
    /// Where a ray's end is seen across the view [px].
    dvec2 shown(const BentHit& end) const {
        dvec3 seen = end.hit ? end.at.x - camera.position : end.at.p;
        if (camera.projection == Projection::Perspective) seen /= glm::dot(seen, camera.forward);
        return camera.f_px * dvec2(glm::dot(seen, camera.right), glm::dot(seen, camera.up));
    }
};

/// One line of the table.
void print_row(const std::string& name, const Grid& grid, const std::vector<BentHit>& exact, double tolerance) {
    std::vector<double> times;
    std::vector<BentHit> ends;
    for (int run = 0; run < kRuns; ++run) {
        const std::clock_t start = std::clock();
        ends = grid.follow(tolerance);
        times.push_back(1e6 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    }
    std::nth_element(times.begin(), times.begin() + kRuns / 2, times.end());
    double error = 0, estimate = 0, steps = 0;
    int other = 0;
    for (std::size_t i = 0; i < ends.size(); ++i) {
        steps += ends[i].steps;
        if (ends[i].hit != exact[i].hit || ends[i].surface.object != exact[i].surface.object) {
            ++other;
            continue;
        }
        error = std::max(error, glm::length(grid.shown(ends[i]) - grid.shown(exact[i])));
        estimate = std::max(estimate, ends[i].error_px);
    }
    const double count = static_cast<double>(grid.rays.size());
    fmt::print("{},{:.3g},{:.4g},{:.3g},{:.3g},{},{:.1f}\n", name, tolerance, times[kRuns / 2] / count, error, estimate,
               other, steps / count);
}

}  // namespace
}  // namespace eikonal::reference

int main(int argc, char** argv) {
    using namespace eikonal;
    using namespace eikonal::reference;
    if (argc != 2) {
        fmt::print(stderr, "usage: tolerance FOLDER_OF_SAMPLES > tolerance.csv\n");
        return 2;
    }
    const std::pair<std::string, std::vector<std::string>> scenes[] = {
        {"mirage", {"medium.1="}}, {"fig5", {}}, {"fig6", {}}};
    fmt::print("scene,tolerance,us,error_px,estimate_px,other_objects,steps\n");
    for (const auto& [name, settings] : scenes) {
        const Grid grid(read_scene(std::filesystem::path(argv[1]) / (name + ".toml"), settings, {}));
        const std::vector<BentHit> exact = grid.follow(kFinest);
        for (double exponent = 0; exponent >= -6.01; exponent -= 0.5)
            print_row(name, grid, exact, std::pow(10.0, exponent));
    }
}
