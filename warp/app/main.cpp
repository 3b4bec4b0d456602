/// eikonal: adds physically computed heat shimmer to footage. Declare options, validate, run, report.

#include <fmt/format.h>
#include <malloc.h>

#include <cstdio>
#include <cstdlib>
#include <exception>

#include "noise/base/error.h"
#include "warp/app/commands.h"
#include "warp/app/pipeline.h"
#include "warp/app/shot.h"
#include "warp/image/interrupt.h"
#include "warp/scene/scene_place.h"

namespace {

/// Frames are tens of megabytes, allocated and freed at every turn: keep the pages instead of asking for fresh ones.
void keep_freed_memory() {
    mallopt(M_MMAP_MAX, 0);
    mallopt(M_TRIM_THRESHOLD, -1);
}

/// Runs a command; messages on its scene come to name file and line.
template <class Options>
int run_command(const Options& options) {
    using namespace eikonal;
    try {
        return run(options);
    } catch (const UserError& error) {
        if constexpr (requires { options.scene.settings; })
            throw UserError(with_place(error.what(), scene_file_of(options.scene), options.scene.settings));
        throw;
    }
}

int run_program(int argc, char** argv) {
    using namespace eikonal;
    constexpr int kFrameFailed = 1, kWrongUsage = 2;
    try {
        catch_interrupts("eikonal");
        return std::visit([](const auto& options) { return run_command(options); }, parse_options(argc, argv));
    } catch (const UserError& error) {
        fmt::print(stderr, "eikonal: {}\n", error.what());
        return kWrongUsage;
    } catch (const FrameError& error) {
        const bool cut_short = error.what() == kInterrupted;  // before the first frame
        fmt::print(stderr, "eikonal: {}{}\n", error.what(), cut_short ? "; the same command makes the rest" : "");
        return kFrameFailed;
    } catch (const std::bad_alloc&) {
        fmt::print(stderr, "eikonal: not enough memory; fewer --threads or smaller pictures need less\n");
        return kFrameFailed;
    } catch (const std::exception& error) {
        fmt::print(stderr, "eikonal: internal error, please report it: {}\n", error.what());
        return kFrameFailed;
    }
}

}  // namespace

int main(int argc, char** argv) {
    keep_freed_memory();
    const int status = run_program(argc, argv);
    // Everything of ours is closed. The global destructors of some 250 libraries would only delay the prompt.
    const bool written = std::fflush(nullptr) == 0;
    std::_Exit(status == 0 && !written ? 1 : status);
}
