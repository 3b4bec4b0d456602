/// `eikonal presets`, and the output of --help and --version.

#include <fmt/format.h>

#include "warp/app/commands.h"
#include "warp/scene/scene.h"

namespace eikonal {

int run(const PresetsOptions&, const std::stop_token&) {
    for (const Preset& preset : list_presets()) fmt::print("{:<14} {}\n", preset.name, preset.description);
    return 0;
}

int run(const Information& information, const std::stop_token&) {
    fmt::print("{}", information.text);
    return 0;
}

}  // namespace eikonal
