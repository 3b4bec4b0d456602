/// Exit statuses, and the one line on stderr that states why a program fails.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace eikonal {

/// Exit status 0 is success: every frame is written, or help was printed.
inline constexpr int kFrameFailed = 1, kWrongUsage = 2;

/// Words that the error line of a program needs.
struct ProgramWords {
    std::string name;         ///< every line begins with it
    std::string less_memory;  ///< advice for a run that lacks memory
    std::string resume;       ///< advice after an interrupt; added only to an error that is an interrupt
};

/// Runs `run` and returns its exit status. If it throws UserError, the status is kWrongUsage. If it throws anything
/// else, the status is kFrameFailed. The message is printed on stderr.
int exit_status(const ProgramWords& words, const std::function<int()>& run);

/// Runs a command that reads a scene. If the command throws a UserError whose message begins with a key of the scene,
/// the place of that key is put before the message (scene_place.h).
int with_scene_places(const std::filesystem::path& scene, const std::vector<std::string>& settings,
                      const std::function<int()>& run);

}  // namespace eikonal
