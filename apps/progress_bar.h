// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/progress.h"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

namespace apps {

/// Shows the progress of one job on standard error: its stage, and of that the fraction, the rate
/// and the time left, or how long it has taken so far where nobody can say more. On a terminal that
/// is a bar, else a line per 10 % and per half minute. Jobs under a second stay silent, and all
/// with --quiet.
class ProgressBar {
 public:
    explicit ProgressBar(std::string title);
    ~ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    /// Reports here; stops when a StoppableWork is interrupted.
    core::Progress progress();

 private:
    using Clock = std::chrono::steady_clock;

    void begin_stage(int number, int count, const std::string& name);
    void report(double fraction, const std::string& detail);
    void show_if_due();
    std::string heading() const;  ///< job and stage
    std::string bar() const;      ///< empty while the fraction is not known
    std::string status() const;   ///< fraction, detail, time

    std::string title_;
    bool is_bar_;
    Clock::time_point start_;

    std::mutex mutex_;  ///< of what stands below
    std::string stage_;
    std::string detail_;
    double fraction_ = 0.0;
    Clock::time_point stage_start_;
    Clock::time_point
        fraction_start_;  ///< when the fraction was first_fraction_, the first that was known
    double first_fraction_ = 0.0;
    Clock::time_point last_shown_;
    int last_tenth_ = -1;  ///< of a stage; -1: nothing of it was shown yet
    bool is_over_ = false;
    std::condition_variable over_;
    std::thread clock_;  ///< shows how long it takes while nothing is reported
};

}  // namespace apps
