/// eikonal: adds physically computed heat shimmer to footage. main declares options, validates them, runs and reports.

#include <malloc.h>

#include <cstdio>
#include <cstdlib>

#include "warp/app/commands.h"
#include "warp/app/shot_options.h"
#include "warp/program/exit_status.h"
#include "warp/program/interrupt.h"

namespace {

/// Keeps freed memory for reuse. Every frame allocates and frees tens of megabytes; fresh pages each time would be
/// slow.
void keep_freed_memory() {
    mallopt(M_MMAP_MAX, 0);
    mallopt(M_TRIM_THRESHOLD, -1);
}

/// The scene file that a command reads; null for a command that reads none.
template <class Options>
const eikonal::SceneOptions* scene_of(const Options& options) {
    if constexpr (requires { options.shot.scene; }) return &options.shot.scene;
    if constexpr (requires { options.scene; }) return &options.scene;
    return nullptr;
}

int run_command(const eikonal::Command& command, const std::stop_token& stop) {
    using namespace eikonal;
    return std::visit(
        [&](const auto& options) {
            const SceneOptions* scene = scene_of(options);
            if (scene == nullptr) return run(options, stop);
            return with_scene_places(scene_file_of(*scene), scene->settings, [&] { return run(options, stop); });
        },
        command);
}

}  // namespace

int main(int argc, char** argv) {
    using namespace eikonal;
    const Interrupts interrupts("eikonal");
    keep_freed_memory();
    const ProgramWords words{"eikonal", "fewer --threads or smaller pictures need less",
                             "the same command makes the rest"};
    const int status = exit_status(words, [&] { return run_command(parse_options(argc, argv), interrupts.token()); });
    // All files are closed here. Ending without the global destructors of some 250 libraries saves their time.
    const bool written = std::fflush(nullptr) == 0;
    std::_Exit(status == 0 && !written ? kFrameFailed : status);
}
