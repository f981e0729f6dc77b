// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace apps {

/// The processor, how many of it this process may use, and memory, in words.
std::string machine_text();

/// Compiler and libraries that decide speed, with versions.
std::string libraries_text();

}  // namespace apps
