/// eikonal-trace: declare options, validate, run, report. Exit statuses as in reference/README.md.
#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/info.h>

#include <cstdio>

#include "noise/base/error.h"
#include "reference/app/commands.h"
#include "warp/image/interrupt.h"
#include "warp/image/picture.h"
#include "warp/scene/scene_place.h"

namespace eikonal::reference {

int run(const Information& information) {
    fmt::print("{}", information.text);
    return 0;
}

namespace {

int run_command(const Command& command) {
    return std::visit(
        [](const auto& options) {
            int threads = 0;
            if constexpr (requires { options.common; }) threads = options.common.threads;
            if (threads == 0) threads = oneapi::tbb::info::default_concurrency();
            const oneapi::tbb::global_control limit(oneapi::tbb::global_control::max_allowed_parallelism,
                                                    static_cast<std::size_t>(threads));
            set_image_threads(threads);
            try {
                return run(options);
            } catch (const UserError& error) {
                if constexpr (requires { options.common; })
                    throw UserError(with_place(error.what(), options.common.scene, options.common.settings));
                throw;
            }
        },
        command);
}

int fail(const std::string& text, int status) {
    fmt::print(stderr, "eikonal-trace: {}\n", text);
    return status;
}

}  // namespace
}  // namespace eikonal::reference

int main(int argc, char** argv) {
    using namespace eikonal;
    constexpr int kFrameFailed = 1, kWrongUsage = 2;
    catch_interrupts("eikonal-trace");
    try {
        return reference::run_command(reference::parse_options(argc, argv));
    } catch (const UserError& error) {
        return reference::fail(error.what(), kWrongUsage);
    } catch (const FrameError& error) {
        return reference::fail(error.what(), kFrameFailed);
    } catch (const std::bad_alloc&) {
        return reference::fail("not enough memory; a smaller picture or lattice needs less", kFrameFailed);
    } catch (const std::exception& error) {
        return reference::fail(std::string("internal error, please report it: ") + error.what(), kFrameFailed);
    }
}
