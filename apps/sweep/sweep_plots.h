// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/gnuplot.h"
#include "apps/sweep/sweep_settings.h"

#include <map>
#include <string>

namespace apps {

/// Throws core::Error for plots that cannot be drawn: of an unknown score, or against a key that is
/// not in the grid or has no two different numbers.
///
/// where   names the sweep file in messages
void check_plots(const SweepSettings& sweep, const std::string& where);

/// The plots of a sweep's results, by the name of their file: one curve for every combination of
/// the other keys' values, with means over repeats. What would be too many curves is spread over
/// several plots. Values of `null` along x are dashed lines across.
///
/// rows   as SweepResults has them
std::map<std::string, Plot> plots_of(const SweepSettings& sweep, const core::Json& rows);

}  // namespace apps
