// SPDX-License-Identifier: MIT
#include "renderer/core/system/process.h"

#include "renderer/core/error.h"

#include <fmt/core.h>
#include <sys/resource.h>
#include <unistd.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <ctime>
#include <fstream>
#include <string>

namespace core {

std::uint64_t peak_rss_bytes() {
    // What getrusage() says of a program begins with the memory of the process that started it.
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);) {
        if (line.starts_with("VmHWM:")) return std::stoull(line.substr(6)) * 1024;
    }
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

void reset_peak_rss() {
#ifdef __GLIBC__
    malloc_trim(0);  // freed memory that the allocator keeps would count
#endif
    std::ofstream("/proc/self/clear_refs") << "5";
}

std::uint64_t available_memory_bytes() {
    std::ifstream meminfo("/proc/meminfo");
    std::string key;
    std::uint64_t kibibytes = 0;
    std::string unit;
    while (meminfo >> key >> kibibytes >> unit) {
        if (key == "MemAvailable:") return kibibytes * 1024;
    }
    const auto pages = static_cast<std::uint64_t>(sysconf(_SC_AVPHYS_PAGES));
    return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

void require_memory(std::uint64_t bytes, const std::string& where) {
    constexpr double kGibibyte = 1024.0 * 1024.0 * 1024.0;
    const std::uint64_t available = available_memory_bytes();
    if (bytes > available) {
        throw Failure(where,
                      fmt::format("needs {:.1f} GiB of memory, {:.1f} GiB are free",
                                  static_cast<double>(bytes) / kGibibyte,
                                  static_cast<double>(available) / kGibibyte));
    }
}

double cpu_seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

}  // namespace core
