// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

namespace core {

/// The largest amount of memory this process has held so far [bytes].
std::uint64_t peak_rss_bytes();

/// Starts peak_rss_bytes() anew from what the process holds now; without effect where the system
/// does not offer it.
void reset_peak_rss();

/// Memory that the machine can still give [bytes].
std::uint64_t available_memory_bytes();

/// Throws Failure, with both numbers, when the machine cannot give `bytes` of memory.
void require_memory(std::uint64_t bytes, const std::string& where);

/// CPU time of all threads of this process so far [s].
double cpu_seconds();

}  // namespace core
