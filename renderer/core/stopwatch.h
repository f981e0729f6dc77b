// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <ctime>

namespace core {

/// Measures wall-clock time from its construction on.
class Stopwatch {
 public:
    double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point start_ = Clock::now();
};

/// Measures the processor time of its thread from its construction on.
class ThreadStopwatch {
 public:
    double seconds() const { return now() - start_; }

 private:
    static double now() {
        timespec time{};
        ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
        return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
    }
    double start_ = now();
};

}  // namespace core
