// SPDX-License-Identifier: MIT
#include "apps/bench/machine.h"

#include "renderer/core/parallel.h"

#include <fmt/core.h>

#include <fstream>

namespace apps {
namespace {

// The first value of a `name : value` line of a file of the system.
std::string value_in(const std::string& path, const std::string& name) {
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        if (!line.starts_with(name)) continue;
        const auto start = line.find_first_not_of(" \t", line.find(':') + 1);
        return start == std::string::npos ? "" : line.substr(start);
    }
    return "";
}

}  // namespace

std::string machine_text() {
    const std::string processor = value_in("/proc/cpuinfo", "model name");
    return fmt::format("{}, {} of its threads, memory {}",
                       processor.empty() ? "unknown processor" : processor,
                       core::thread_count(),
                       value_in("/proc/meminfo", "MemTotal"));
}

std::string libraries_text() {
    return "GCC " __VERSION__ NLOS_LIBRARIES;
}

}  // namespace apps
