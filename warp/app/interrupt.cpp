#include "warp/app/interrupt.h"

#include <unistd.h>
#include <atomic>

#include <csignal>
#include <string_view>

namespace eikonal {
namespace {

std::atomic<bool> flag{false};
static_assert(std::atomic<bool>::is_always_lock_free);

void raise_flag(int) {
    if (!flag.exchange(true)) return;
    // The second time at once, with what a signal handler may do; the next run removes the files begun.
    constexpr std::string_view kText = "\neikonal: interrupted at once; finished frames are whole\n";
    if (write(STDERR_FILENO, kText.data(), kText.size()) < 0) _exit(1);
    _exit(1);
}

}  // namespace

void catch_interrupts() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, raise_flag);
    // A closed pipe and a file beyond the size limit are errors of the write that meets them.
    for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
}

bool interrupted() {
    return flag;
}

}  // namespace eikonal
