// SPDX-License-Identifier: MIT
#include "apps/terminal.h"

#include "renderer/core/output_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>

namespace apps {
namespace {

using Clock = std::chrono::steady_clock;

std::atomic<bool> g_interrupted{false};
std::atomic<int> g_stoppable_jobs{0};
std::atomic<bool> g_bar_is_open{false};

void write_safely(std::string_view text) {
    [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size());
}

// Calls only what signal handlers may call.
void on_interrupt(int) {
    if (g_stoppable_jobs > 0 && !g_interrupted.exchange(true)) return;
    core::remove_partial_files();
    constexpr std::string_view kClearLine = "\r\033[K";
    constexpr std::string_view kMessage = "nlos: interrupted\n";
    if (g_bar_is_open) write_safely(kClearLine);
    write_safely(kMessage);
    ::_exit(EXIT_FAILURE);
}

// A result that is opened while a standard stream is closed would take its place, and messages
// would be written into it.
void open_standard_streams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (::fcntl(stream, F_GETFD) < 0) ::open("/dev/null", O_RDONLY);
    }
}

double seconds(Clock::duration duration) {
    return std::chrono::duration<double>(duration).count();
}

constexpr double kSilentSeconds = 1.0;
constexpr double kSecondsBetweenBars = 0.1;
constexpr int kBarWidth = 30;

}  // namespace

void write_output(std::string_view text) {
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) flush_output();
}

void flush_output() {
    errno = 0;
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return;
    throw core::Failure("standard output",
                        std::string("cannot be written (") + std::strerror(errno) + ")");
}

void write_error(std::string_view text) noexcept {
    std::fwrite(text.data(), 1, text.size(), stderr);
}

void handle_signals() {
    open_standard_streams();
    for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, on_interrupt);
    for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
}

bool interrupt_requested() {
    return g_interrupted;
}

ProgressBar::ProgressBar(std::string title)
    : title_(std::move(title)),
      start_(Clock::now()),
      last_shown_(start_),
      is_terminal_(::isatty(STDERR_FILENO) == 1) {
    ++g_stoppable_jobs;
}

ProgressBar::~ProgressBar() {
    --g_stoppable_jobs;
    if (g_bar_is_open.exchange(false)) write_error("\r\033[K");
}

core::Progress ProgressBar::progress() {
    core::Progress progress;
    progress.report = [this](double share, const std::string& detail) { show(share, detail); };
    progress.announce = [](const std::string& text) {
        print("{}\n", text);
        flush_output();
    };
    progress.warn = [](const std::string& text) { print_error("warning: {}\n", text); };
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
        write_error(message("\r\033[K{} [{}{}] {}",
                            title_,
                            std::string(static_cast<std::size_t>(filled), '#'),
                            std::string(static_cast<std::size_t>(kBarWidth - filled), '.'),
                            status));
        g_bar_is_open = true;
        return;
    }
    const int tenth = static_cast<int>(share * 10.0);
    if (tenth > last_tenth_) print_error("{} {}\n", title_, status);
    last_tenth_ = std::max(tenth, last_tenth_);
}

}  // namespace apps
