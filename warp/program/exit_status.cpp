#include "warp/program/exit_status.h"

#include <fmt/format.h>

#include <cstdio>
#include <new>

#include "noise/base/error.h"
#include "warp/program/option_names.h"
#include "warp/scene/scene_place.h"

namespace eikonal {

int exit_status(const ProgramWords& words, const std::function<int()>& run) {
    const auto fail = [&](const std::string& text, int status) {
        fmt::print(stderr, "{}: {}\n", words.name, with_options(text));
        return status;
    };
    try {
        return run();
    } catch (const UserError& error) {
        return fail(error.what(), kWrongUsage);
    } catch (const FrameError& error) {
        const std::string text = error.what();
        return fail(text == kStopped ? text + "; " + words.resume : text, kFrameFailed);
    } catch (const std::bad_alloc&) {
        return fail("not enough memory; " + words.less_memory, kFrameFailed);
    } catch (const std::exception& error) {
        return fail(fmt::format("internal error, please report it: {}", error.what()), kFrameFailed);
    }
}

int with_scene_places(const std::filesystem::path& scene, const std::vector<std::string>& settings,
                      const std::function<int()>& run) {
    try {
        return run();
    } catch (const UserError& error) {
        throw UserError(with_place(error.what(), scene, settings));
    }
}

}  // namespace eikonal
