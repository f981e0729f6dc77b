// SPDX-License-Identifier: MIT
#pragma once

#include "apps/command.h"

namespace apps {

/// Declares `nlos bench` with all benchmarks.
void declare_bench(Command& command);

}  // namespace apps
