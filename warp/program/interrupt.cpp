// A signal handler must not call std::stop_source::request_stop, which takes a lock and calls callbacks. It may post a
// semaphore. A thread waits for this semaphore and requests the stop.
//
// Blocked signals and sigwait would do without a handler. The handler is needed because it also ends a read that waits.

#include "warp/program/interrupt.h"

#include <semaphore.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <initializer_list>
#include <string_view>

namespace eikonal {
namespace {

// The handler uses these. A signal may arrive after Interrupts has ended, so they live as long as the program.
std::atomic<bool> raised{false};
std::atomic<const char*> name{""};
sem_t wake;
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<const char*>::is_always_lock_free);

constexpr std::initializer_list<int> kSignals{SIGINT, SIGTERM, SIGHUP};

void handle(int) {
    const int error = errno;
    if (!raised.exchange(true)) {
        sem_post(&wake);
        errno = error;
        return;
    }
    for (const std::string_view text : {std::string_view("\n"), std::string_view(name.load()),
                                        std::string_view(": interrupted at once; finished frames are whole\n")})
        if (write(STDERR_FILENO, text.data(), text.size()) < 0) _exit(1);
    _exit(1);
}

void set_handlers() {
    struct sigaction action {};
    sigemptyset(&action.sa_mask);
    action.sa_handler = handle;  // SA_RESTART is not set, so that a read or write that waits ends
    for (const int signal : kSignals) sigaction(signal, &action, nullptr);
    action.sa_handler = SIG_IGN;
    for (const int signal : {SIGPIPE, SIGXFSZ}) sigaction(signal, &action, nullptr);
}

}  // namespace

Interrupts::Interrupts(const char* program) {
    name = program;
    sem_init(&wake, 0, 0);
    // The watching thread blocks all signals. The system then delivers them to a thread that may be waiting in a read.
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    watcher_ = std::thread([this] {
        while (sem_wait(&wake) != 0) {
        }
        if (raised) stop_.request_stop();
    });
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    set_handlers();
}

Interrupts::~Interrupts() {
    sem_post(&wake);
    watcher_.join();
}

}  // namespace eikonal
