/// `eikonal-trace path`: writes one bent ray as numbers.
#include <fmt/format.h>

#include <fstream>
#include <iostream>
#include <limits>

#include "noise/base/error.h"
#include "reference/app/commands.h"
#include "reference/trace/path.h"
#include "warp/image/atomic_file.h"

namespace eikonal::reference {
namespace {

const char* ending(const BentHit& end) {
    switch (end.end) {
        case BentHit::End::Surface:
            return "met a surface";
        case BentHit::End::Escaped:
            return "reached its length";
        case BentHit::End::Trapped:
            return "bends by more than numbers hold";
        case BentHit::End::Unfinished:
            return "was ended by its step budget";
        case BentHit::End::NoIndex:
            return "came to where there is no index of refraction";
    }
    return "";
}

}  // namespace

int run(const PathOptions& o, const std::stop_token&) {
    const Scene scene = read_scene(o.common.scene, o.common.settings, o.common.seed);
    const SceneAir air(scene, o.rays, {o.length, o.tolerance, false});
    // A ray may start on the surface itself.
    if (const auto below = air.below_surface(o.origin); below && below->depth > 0)
        throw UserError(fmt::format(
            "--origin {:g},{:g},{:g}: is {:g} m below the surface of medium.{}, where there is no air; it must "
            "not be below it: start higher, or lower the surface",
            o.origin.x, o.origin.y, o.origin.z, below->depth, below->medium));
    TraceSettings trace = air.trace_settings(air.path().reference());
    trace.perspective = false;
    trace.pixel = 1;
    trace.tolerance_px = o.tolerance;
    trace.u_end = o.length;
    trace.step_budget = o.rays.step_budget;
    trace.end_trapped = false;  // the length of the ray is given
    std::optional<Geometry> geometry;
    if (!scene.objects.empty()) geometry.emplace(scene, o.origin);
    const AirInstant field = air.at(o.frame.value_or(scene.time.first_frame));
    trace.far = std::numeric_limits<double>::infinity();
    const auto write = [&](std::ostream& stream, const std::string& name) {
        return write_path(field, geometry ? &*geometry : nullptr, o.origin, o.direction, trace, stream, name);
    };
    BentHit end;
    if (o.output) {
        AtomicFile file(*o.output);
        std::ofstream stream(file.temporary());
        end = write(stream, o.output->string());
        stream.close();
        if (!stream) throw FrameError(fmt::format("cannot write '{}'", o.output->string()));
        file.commit();
    } else {
        end = write(std::cout, "standard output");
        std::cout.flush();
    }
    if (trace.integrator == Integrator::Adaptive && too_far_off(end, o.tolerance))
        fmt::print(stderr,
                   "warning: its end may be off by {:.2g} m, as it estimates, and not only by --tolerance {:g}\n",
                   end.error_px, o.tolerance);
    fmt::print(stderr, "the ray {} at u = {:.9g} m after {} steps\n", ending(end), end.at.u, end.steps);
    return end.ended() ? 0 : 1;
}

}  // namespace eikonal::reference
