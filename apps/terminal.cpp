// SPDX-License-Identifier: MIT
#include "apps/terminal.h"

#include <fmt/core.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>

namespace apps {
namespace {

using Clock = std::chrono::steady_clock;

std::atomic<bool> g_interrupted{false};

void on_interrupt(int) {
    g_interrupted = true;
    std::signal(SIGINT, SIG_DFL);
}

double seconds(Clock::duration duration) {
    return std::chrono::duration<double>(duration).count();
}

constexpr double kSilentSeconds = 1.0;
constexpr double kSecondsBetweenBars = 0.1;
constexpr int kBarWidth = 30;

}  // namespace

void catch_interrupt() {
    std::signal(SIGINT, on_interrupt);
}

bool interrupt_requested() {
    return g_interrupted;
}

ProgressBar::ProgressBar(std::string title)
    : title_(std::move(title)),
      start_(Clock::now()),
      last_shown_(start_),
      is_terminal_(::isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
    if (bar_is_open_) std::fputs("\r\033[K", stderr);
}

core::Progress ProgressBar::progress() {
    core::Progress progress;
    progress.report = [this](double share, const std::string& detail) { show(share, detail); };
    progress.announce = [](const std::string& text) {
        fmt::print("{}\n", text);
        std::fflush(stdout);
    };
    progress.stop_requested = interrupt_requested;
    return progress;
}

void ProgressBar::show(double share, const std::string& detail) {
    const auto now = Clock::now();
    const double elapsed = seconds(now - start_);
    if (elapsed < kSilentSeconds) return;
    const double left = share > 0.0 ? elapsed / share * (1.0 - share) : 0.0;
    const std::string status =
        fmt::format("{:3.0f} %  {}  {:.0f} s left", 100.0 * share, detail, left);
    if (is_terminal_) {
        if (seconds(now - last_shown_) < kSecondsBetweenBars) return;
        last_shown_ = now;
        const int filled = static_cast<int>(share * kBarWidth);
        fmt::print(stderr,
                   "\r\033[K{} [{}{}] {}",
                   title_,
                   std::string(static_cast<std::size_t>(filled), '#'),
                   std::string(static_cast<std::size_t>(kBarWidth - filled), '.'),
                   status);
        std::fflush(stderr);
        bar_is_open_ = true;
        return;
    }
    const int tenth = static_cast<int>(share * 10.0);
    if (tenth > last_tenth_) fmt::print(stderr, "{} {}\n", title_, status);
    last_tenth_ = std::max(tenth, last_tenth_);
}

}  // namespace apps
