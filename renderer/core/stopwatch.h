// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>

namespace core {

/// Measures wall-clock time from its construction on.
class Stopwatch {
 public:
    double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

 private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point start_ = Clock::now();
};

}  // namespace core
