// SPDX-License-Identifier: MIT
#include "apps/terminal.h"

#include "renderer/core/system/output_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>

namespace apps {
namespace {

constexpr std::string_view kClearLine = "\r\033[K";

// Signals this close to the first are the same one: some programs send it to a process and then to
// its group.
constexpr std::int64_t kSameSignal_ms = 50;

std::atomic<std::int64_t> g_interrupted_ms{0};  // when the first signal came; 0: none has
std::atomic<const char*> g_answer{nullptr};     // to the first interruption of stoppable work
std::atomic<bool> g_line_is_drawn{false};

void write_safely(std::string_view text) {
    [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, text.data(), text.size());
}

std::int64_t clock_ms() {
    timespec time{};
    ::clock_gettime(CLOCK_MONOTONIC, &time);
    return 1 + std::int64_t{time.tv_sec} * 1000 + time.tv_nsec / 1'000'000;
}

// Calls only what signal handlers may call.
void on_interrupt(int) {
    const char* answer = g_answer;
    const std::int64_t now_ms = clock_ms();
    std::int64_t first_ms = 0;
    const bool is_first = g_interrupted_ms.compare_exchange_strong(first_ms, now_ms);
    if (answer != nullptr && !is_first && now_ms - first_ms < kSameSignal_ms) return;
    if (g_line_is_drawn.exchange(false)) write_safely(kClearLine);
    if (answer != nullptr && is_first) return write_safely(answer);
    core::remove_partial_files();
    write_safely("nlos: interrupted\n");
    ::_exit(EXIT_FAILURE);
}

// A result that is opened while a standard stream is closed would take its place, and messages
// would be written into it.
void open_standard_streams() {
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (::fcntl(stream, F_GETFD) < 0) ::open("/dev/null", O_RDONLY);
    }
}

}  // namespace

void write_output(std::string_view text) {
    clear_drawn_line();
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) flush_output();
}

void write_message(std::string_view text) {
    if (!output_settings().quiet) write_output(text);
}

void flush_output() {
    errno = 0;
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return;
    throw core::Failure("standard output",
                        std::string("cannot be written (") + std::strerror(errno) + ")");
}

void write_error(std::string_view text) noexcept {
    clear_drawn_line();
    std::fwrite(text.data(), 1, text.size(), stderr);
}

OutputSettings& output_settings() {
    static OutputSettings settings;
    return settings;
}

bool can_redraw_lines() {
    const auto holds = [](const char* name, std::string_view value) {
        const char* found = std::getenv(name);
        return found != nullptr && (value.empty() ? *found != '\0' : found == value);
    };
    return ::isatty(STDERR_FILENO) == 1 && !holds("NO_COLOR", "") && !holds("TERM", "dumb");
}

void clear_drawn_line() noexcept {
    if (!g_line_is_drawn.exchange(false)) return;
    std::fwrite(kClearLine.data(), 1, kClearLine.size(), stderr);
}

void draw_line(std::string_view text) noexcept {
    std::string line(kClearLine);
    line += text;
    std::fwrite(line.data(), 1, line.size(), stderr);
    g_line_is_drawn = true;
}

void handle_signals() {
    open_standard_streams();
    for (const int signal : {SIGINT, SIGTERM}) std::signal(signal, on_interrupt);
    for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
}

bool interrupt_requested() {
    return g_interrupted_ms != 0;
}

StoppableWork::StoppableWork(const std::string& answer)
    : line_("nlos: " + answer + "\n"), outer_(g_answer.exchange(line_.c_str())) {}

StoppableWork::~StoppableWork() {
    g_answer = outer_;
}

}  // namespace apps
