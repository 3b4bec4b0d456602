/// eikonal: adds physically computed heat shimmer to footage. Declare options, validate, run, report.

#include <fmt/format.h>

#include <cstdio>
#include <exception>

#include "noise/error.h"
#include "warp/app/commands.h"
#include "warp/app/interrupt.h"

int main(int argc, char** argv) {
    using namespace eikonal;
    constexpr int kFrameFailed = 1, kWrongUsage = 2;
    try {
        catch_interrupts();
        return std::visit([](const auto& options) { return run(options); }, parse_options(argc, argv));
    } catch (const UserError& error) {
        fmt::print(stderr, "eikonal: {}\n", error.what());
        return kWrongUsage;
    } catch (const FrameError& error) {
        fmt::print(stderr, "eikonal: {}\n", error.what());
        return kFrameFailed;
    } catch (const std::bad_alloc&) {
        fmt::print(stderr, "eikonal: not enough memory; fewer --threads or smaller pictures need less\n");
        return kFrameFailed;
    } catch (const std::exception& error) {
        fmt::print(stderr, "eikonal: internal error, please report it: {}\n", error.what());
        return kFrameFailed;
    }
}
