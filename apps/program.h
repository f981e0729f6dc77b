// SPDX-License-Identifier: MIT
#pragma once

#include "apps/command.h"

#include <map>
#include <string>

namespace apps {

/// Runs the command that the arguments of `nlos` name.
///
/// beside    how commands are declared that all_commands() leaves to `nlos-bench`; empty: that
///           program takes the place of this one for them
/// returns   its exit status: 0, 1 where it failed or was interrupted, 2 for bad input
int run_nlos(int argc, char** argv, const std::map<std::string, void (*)(Command&)>& beside = {});

}  // namespace apps
