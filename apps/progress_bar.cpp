// SPDX-License-Identifier: MIT
#include "apps/progress_bar.h"

#include "apps/outcome.h"
#include "apps/terminal.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <utility>

namespace apps {
namespace {

constexpr double kSilentSeconds = 1.0;
constexpr double kSecondsBetweenBars = 0.1;
constexpr double kSecondsBetweenLines = 30.0;
constexpr std::chrono::milliseconds kTick{500};
constexpr std::size_t kBarWidth = 30;

double seconds_between(std::chrono::steady_clock::time_point begin,
                       std::chrono::steady_clock::time_point end) {
    return std::chrono::duration<double>(end - begin).count();
}

// What of a text fits into a line of the terminal; a longer one would not be cleared as a whole.
std::string fitting(std::string text) {
    winsize size{};
    if (::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col < 2) return text;
    std::size_t end = std::min<std::size_t>(text.size(), size.ws_col - 1U);
    while (end > 0 && end < text.size() && (static_cast<unsigned char>(text[end]) >> 6) == 0x2) {
        --end;
    }
    text.resize(end);
    return text;
}

}  // namespace

ProgressBar::ProgressBar(std::string title)
    : title_(std::move(title)),
      is_bar_(can_redraw_lines()),
      start_(Clock::now()),
      stage_start_(start_),
      fraction_start_(start_),
      last_shown_(start_) {
    if (output_settings().quiet) return;
    clock_ = std::thread([this] {
        std::unique_lock lock(mutex_);
        while (!over_.wait_for(lock, kTick, [this] { return is_over_; })) show_if_due();
    });
}

ProgressBar::~ProgressBar() {
    {
        const std::lock_guard lock(mutex_);
        is_over_ = true;
    }
    over_.notify_all();
    if (clock_.joinable()) clock_.join();
    clear_drawn_line();
}

core::Progress ProgressBar::progress() {
    core::Progress progress;
    progress.begin_stage = [this](int number, int count, const std::string& name) {
        begin_stage(number, count, name);
    };
    progress.report = [this](double fraction, const std::string& detail) {
        report(fraction, detail);
    };
    progress.announce = [this](const std::string& text) {
        const std::lock_guard lock(mutex_);
        clear_drawn_line();
        print("{}\n", text);
        flush_output();
    };
    progress.warn = [this](const std::string& text) {
        const std::lock_guard lock(mutex_);
        warn(text);
    };
    progress.stop_requested = interrupt_requested;
    return progress;
}

void ProgressBar::begin_stage(int number, int count, const std::string& name) {
    const std::lock_guard lock(mutex_);
    stage_ = fmt::format(", stage {} of {}: {}", number, count, name);
    stage_start_ = Clock::now();
    fraction_ = 0.0;
    detail_.clear();
    last_tenth_ = -1;
}

void ProgressBar::report(double fraction, const std::string& detail) {
    const std::lock_guard lock(mutex_);
    if (fraction_ <= 0.0 || fraction < fraction_) {
        fraction_start_ = Clock::now();
        first_fraction_ = fraction;
    }
    fraction_ = fraction;
    detail_ = detail;
    show_if_due();
}

void ProgressBar::show_if_due() {
    if (output_settings().quiet || interrupt_requested()) return;
    const auto now = Clock::now();
    if (seconds_between(start_, now) < kSilentSeconds) return;
    const double since_shown = seconds_between(last_shown_, now);
    if (is_bar_) {
        if (since_shown < kSecondsBetweenBars) return;
        draw_line(fitting(message("{} {}{}", heading(), bar(), status())));
    } else {
        const int tenth = static_cast<int>(fraction_ * 10.0);
        const bool is_due = last_tenth_ < 0
                                ? seconds_between(stage_start_, now) >= kSilentSeconds
                                : tenth > last_tenth_ || since_shown >= kSecondsBetweenLines;
        if (!is_due) return;
        print_error("{}: {}\n", heading(), status());
        last_tenth_ = tenth;
    }
    last_shown_ = now;
}

std::string ProgressBar::heading() const {
    return title_ + stage_;
}

std::string ProgressBar::bar() const {
    if (fraction_ <= 0.0) return "";
    const auto filled =
        static_cast<std::size_t>(std::clamp(fraction_, 0.0, 1.0) * double{kBarWidth});
    return "[" + std::string(filled, '#') + std::string(kBarWidth - filled, '.') + "] ";
}

std::string ProgressBar::status() const {
    const auto now = Clock::now();
    const double gained = fraction_ - first_fraction_;
    const std::string time =
        gained > 0.0
            ? fmt::format("{:.0f} s left",
                          seconds_between(fraction_start_, now) / gained * (1.0 - fraction_))
            : fmt::format("{:.0f} s so far", seconds_between(stage_start_, now));
    const std::string fraction =
        fraction_ > 0.0 ? fmt::format("{:.0f} %  ", 100.0 * fraction_) : "";
    return fraction + (detail_.empty() ? "" : detail_ + "  ") + time;
}

}  // namespace apps
