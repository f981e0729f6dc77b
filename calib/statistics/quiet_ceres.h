// SPDX-License-Identifier: MIT
#pragma once

namespace calib {

/// Keeps Ceres from writing to standard error, from the first call on: what went wrong stands in
/// the summary of a solve, and is said in words of our own.
void quiet_ceres();

}  // namespace calib
