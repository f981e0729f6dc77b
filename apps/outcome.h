// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/json_fwd.h"

#include <string>
#include <vector>

namespace apps {

/// What --json says at the end of a command beside its name, status, seconds and memory: the
/// numbers that its text shows. Commands add to it.
core::Json& outcome();

/// Says in outcome() that files or folders were written; empty names are left out.
/// returns   the others, with commas between
std::string note_written(const std::vector<std::string>& paths);

/// Says it in outcome(), and each by a line.
void print_written(const std::vector<std::string>& paths);

/// Prints notes on what was done, a line each, and keeps them in outcome().
///
/// label   before each, as in "not kept"; in outcome() with underscores
void print_notes(std::string label, const std::vector<std::string>& notes);

/// Prints a warning to standard error and notes it in outcome().
void warn(const std::string& text);

/// Prints the last line of --json, if it was asked for, after all other output; not where standard
/// output is closed or full.
///
/// command   as it is typed, "nlos bench render"
/// error     the message of what failed; empty: nothing did
void print_outcome(const std::string& command, int status, const std::string& error) noexcept;

}  // namespace apps
