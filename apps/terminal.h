// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/progress.h"

#include <chrono>
#include <string>

namespace apps {

/// Shows the progress of one job on standard error: a bar with rate and time left on a terminal,
/// one line per 10 % otherwise. Jobs under a second stay silent.
class ProgressBar {
 public:
    explicit ProgressBar(std::string title);
    ~ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    /// Reports here; stops when Ctrl-C was pressed.
    core::Progress progress();

 private:
    void show(double share, const std::string& detail);

    std::string title_;
    std::chrono::steady_clock::time_point start_;
    std::chrono::steady_clock::time_point last_shown_;
    bool is_terminal_;
    bool bar_is_open_ = false;
    int last_tenth_ = 0;
};

/// From now on Ctrl-C sets a flag instead of ending the program; a second one ends it.
void catch_interrupt();
bool interrupt_requested();

}  // namespace apps
