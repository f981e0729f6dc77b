// SPDX-License-Identifier: MIT
#pragma once

namespace apps {

/// The program `nlos`: runs the command that its arguments name.
///
/// returns   its exit status: 0, 1 where it failed or was interrupted, 2 for bad input
int run_nlos(int argc, char** argv);

}  // namespace apps
