// SPDX-License-Identifier: MIT
#pragma once

#include "apps/manual/command_entry.h"

#include <string>

namespace apps {

/// The manual page of a command, in man(7).
///
/// version   as "nlos 0.1.0"
std::string man_page(const CommandEntry& command, const std::string& version);

/// The name of a command's page without the section, "nlos-bench-render".
std::string page_name(const CommandEntry& command);

/// Completion of the program and all its commands for bash and zsh: commands, options, files by
/// suffix, names of closed sets, keys and values of settings. Nothing of it starts the program.
std::string bash_completion(const CommandEntry& program);
std::string zsh_completion(const CommandEntry& program);

/// All commands, options and settings with defaults, ranges and meanings, in Markdown.
std::string reference_page(const CommandEntry& program, const std::string& version);

}  // namespace apps
