// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace apps {

/// What a process may take before the system ends it.
struct ProcessLimits {
    double cpu_seconds = 600.0;
    std::optional<std::uint64_t> data_bytes{};  ///< nothing: what the machine has
};

/// How a process ended, and what it took.
struct MeasuredProcess {
    std::string failure;       ///< empty: it succeeded; else the last line of what it complained of
    std::string last_line;     ///< of its standard output
    bool was_stopped = false;  ///< since it took longer than it may
    double cpu_seconds = 0.0;  ///< user and system time of all its threads, start-up included
};

/// Runs a program to its end, numerical libraries held to one thread.
///
/// arguments   program, looked up in PATH, and its arguments
/// log         file that gets all it prints, to be read where it fails
/// throws      core::Failure when no process can be started
MeasuredProcess run_measured(const std::vector<std::string>& arguments,
                             const std::string& log,
                             const ProcessLimits& limits);

}  // namespace apps
