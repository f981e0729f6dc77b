// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace apps {

/// Runs another program, without a shell; what it says is dropped.
///
/// arguments   its name, to be found on the PATH, and what follows it
/// input       goes to its standard input
/// returns     its exit status, -1 where a signal ended it; nothing when it cannot be started, as
///             when it is not installed
std::optional<int> run_program(std::vector<std::string> arguments, const std::string& input = "");

/// A program that was installed with this one, in the folder of its executable.
///
/// throws   core::Failure when there is none
std::string program_beside(const std::string& name);

/// Runs such a program in the place of this one.
///
/// arguments   what it is told, the name that it is called by first
/// throws      core::Failure when it cannot be started
[[noreturn]] void become(const std::string& name, std::vector<std::string> arguments);

}  // namespace apps
