#include "warp/app/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace eikonal {
namespace {

constexpr auto kBarPeriod = std::chrono::milliseconds(100);
constexpr auto kLinePeriod = std::chrono::seconds(5);

std::string time_text(double seconds) {
    const auto s = static_cast<long>(seconds + 0.5);
    if (s < 60) return fmt::format("{} s", s);
    if (s < 3600) return fmt::format("{}:{:02} min", s / 60, s % 60);
    return fmt::format("{}:{:02}:{:02} h", s / 3600, s / 60 % 60, s % 60);
}

int terminal_width() {
    winsize size{};
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

Progress::Progress(ProgressStyle style, std::size_t total, std::string what)
    : style_(style), total_(total), what_(std::move(what)), start_(Clock::now()), drawn_(start_) {
    if (style_ == ProgressStyle::Auto) style_ = isatty(STDERR_FILENO) ? ProgressStyle::Bar : ProgressStyle::Plain;
    if (style_ == ProgressStyle::Bar) draw(false);
}

Progress::~Progress() {
    if (style_ != ProgressStyle::None && done_ > 0 && !ended_) draw(true);  // stopped, or the total was not exact
    if (on_screen_) std::fputc('\n', stderr);
}

void Progress::draw(bool last) {
    const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
    const bool known = total_ > 0;  // the length of a movie may be unknown
    ended_ = last;
    const double left =
        done_ > 0 && known ? elapsed / static_cast<double>(done_) * static_cast<double>(total_ - done_) : 0;
    const std::size_t made = done_ - failed_;
    const std::string counts =
        (known ? fmt::format(" {}/{} {}", made, total_, what_) : fmt::format(" {} {}", made, what_)) +
        (failed_ > 0 ? fmt::format(", {} failed", failed_) : "");
    const std::string times = last                   ? fmt::format(", {}", time_text(elapsed))
                              : done_ == 0 || !known ? std::string()
                                                     : fmt::format(", {} left", time_text(left));
    if (style_ == ProgressStyle::Plain) {
        fmt::print(stderr, "{}{}\n", counts.substr(1), times);
        return;
    }
    const int room = std::clamp(terminal_width() - static_cast<int>(counts.size() + times.size()) - 3, 4, 40);
    const int filled = total_ > 0 ? static_cast<int>(static_cast<std::size_t>(room) * done_ / total_) : 0;
    std::string bar;
    for (int i = 0; i < room; ++i) bar += i < filled ? "█" : "░";
    fmt::print(stderr, "\r\033[K{}{}{}", bar, counts, times);
    std::fflush(stderr);
    on_screen_ = true;
}

void Progress::step(bool made) {
    const std::lock_guard guard(lock_);
    ++done_;
    if (!made) ++failed_;
    if (style_ == ProgressStyle::None) return;
    const auto now = Clock::now();
    const bool last = done_ == total_;
    if (!last &&
        now - drawn_ < (style_ == ProgressStyle::Bar ? Clock::duration(kBarPeriod) : Clock::duration(kLinePeriod)))
        return;
    drawn_ = now;
    draw(last);
}

void Progress::line(const std::string& text) {
    const std::lock_guard guard(lock_);
    if (on_screen_) fmt::print(stderr, "\r\033[K");
    fmt::print(stderr, "{}\n", text);
    if (on_screen_) draw(false);
}

}  // namespace eikonal
