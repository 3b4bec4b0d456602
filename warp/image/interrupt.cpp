#include "warp/image/interrupt.h"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <initializer_list>
#include <string_view>

namespace eikonal {
namespace {

std::atomic<bool> flag{false};
std::atomic<const char*> name{""};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<const char*>::is_always_lock_free);

void raise_flag(int) {
    if (!flag.exchange(true)) return;
    // The second time at once, with what a signal handler may do; the next run removes the files begun.
    for (const std::string_view text : {std::string_view("\n"), std::string_view(name.load()),
                                        std::string_view(": interrupted at once; finished frames are whole\n")})
        if (write(STDERR_FILENO, text.data(), text.size()) < 0) _exit(1);
    _exit(1);
}

}  // namespace

void catch_interrupts(const char* program) {
    name = program;
    struct sigaction action {};
    sigemptyset(&action.sa_mask);
    // Without SA_RESTART: a read or write that would wait for ever ends.
    action.sa_handler = raise_flag;
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaction(signal, &action, nullptr);
    // A closed pipe and a file beyond the size limit are errors of the write that meets them.
    action.sa_handler = SIG_IGN;
    for (const int signal : {SIGPIPE, SIGXFSZ}) sigaction(signal, &action, nullptr);
}

bool interrupted() {
    return flag;
}

}  // namespace eikonal
