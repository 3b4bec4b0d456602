/// eikonal-trace: main declares options, validates them, runs and reports. Exit statuses as in reference/README.md.
#include <fmt/format.h>

#include "reference/app/commands.h"
#include "warp/program/exit_status.h"
#include "warp/program/interrupt.h"
#include "warp/program/thread_limit.h"

namespace eikonal::reference {

int run(const Information& information, const std::stop_token&) {
    fmt::print("{}", information.text);
    return 0;
}

namespace {

int run_command(const Command& command, const std::stop_token& stop) {
    return std::visit(
        [&](const auto& options) {
            if constexpr (requires { options.common; }) {
                const ThreadLimit limit(options.common.threads);
                return with_scene_places(options.common.scene, options.common.settings,
                                         [&] { return run(options, stop); });
            } else {
                return run(options, stop);
            }
        },
        command);
}

}  // namespace
}  // namespace eikonal::reference

int main(int argc, char** argv) {
    using namespace eikonal;
    const Interrupts interrupts("eikonal-trace");
    const ProgramWords words{"eikonal-trace", "a smaller picture or lattice needs less", "the same command goes on"};
    return exit_status(
        words, [&] { return reference::run_command(reference::parse_options(argc, argv), interrupts.token()); });
}
