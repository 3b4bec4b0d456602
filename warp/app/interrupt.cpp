#include "warp/app/interrupt.h"

#include <atomic>
#include <csignal>

namespace eikonal {
namespace {

std::atomic<bool> flag{false};
static_assert(std::atomic<bool>::is_always_lock_free);

void raise_flag(int signal) {
    if (flag.exchange(true)) std::signal(signal, SIG_DFL);
}

}  // namespace

void catch_interrupts() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, raise_flag);
    std::signal(SIGPIPE, SIG_IGN);
}

bool interrupted() { return flag; }

}  // namespace eikonal
