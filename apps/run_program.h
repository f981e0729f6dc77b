// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace apps {

/// Runs another program, without a shell; what it says on standard error is dropped.
///
/// arguments   its name, to be found on the PATH, and what follows it
/// input       goes to its standard input
/// output      the existing file that its standard output goes to; empty: nowhere
/// returns     its exit status, -1 where a signal ended it; nothing when it cannot be started, as
///             when it is not installed
std::optional<int> run_program(std::vector<std::string> arguments,
                               const std::string& input = "",
                               const std::string& output = "");

}  // namespace apps
