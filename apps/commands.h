// SPDX-License-Identifier: MIT
#pragma once

#include "apps/command.h"

#include <span>

namespace apps {

/// All commands of the program, in the order of its help.
std::span<const CommandRow* const> all_commands();

/// Declares `nlos manual`, which describes every command of the program it belongs to.
void declare_manual(Command& command);

}  // namespace apps
