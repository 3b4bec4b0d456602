/// Exit statuses, and the one line on stderr that tells why a program fails.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace eikonal {

/// 0 is success: every frame is written, or help was printed.
inline constexpr int kFrameFailed = 1, kWrongUsage = 2;

/// What a program says of itself.
struct ProgramWords {
    std::string name;         ///< every line begins with it
    std::string less_memory;  ///< what to do where memory runs out
    std::string resume;       ///< how to go on after an interrupt, for errors that are interrupts alone
};

/// The status of what `run` returns or throws: UserError is kWrongUsage, everything else kFrameFailed. What is thrown
/// is printed.
int exit_status(const ProgramWords& words, const std::function<int()>& run);

/// Runs a command that reads a scene. A UserError that begins with a key of the scene comes to begin with the place of
/// that key (scene_place.h).
int with_scene_places(const std::filesystem::path& scene, const std::vector<std::string>& settings,
                      const std::function<int()>& run);

}  // namespace eikonal
