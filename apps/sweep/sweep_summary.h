// SPDX-License-Identifier: MIT
#pragma once

#include "apps/sweep/sweep_plan.h"
#include "apps/tables/tables.h"
#include "nlos/plots/plot.h"
#include "renderer/core/settings/json_fwd.h"

#include <map>
#include <string>
#include <vector>

namespace apps {

/// What stands at the end of a sweep.
struct SweepSummary {
    std::size_t num_failed = 0;
    std::vector<std::string> warnings;
};

/// Writes DIR/sweep.json (description and table), DIR/sweep.csv, and plots as .svg and .png. Every
/// file appears whole: processes that finish at once write the same.
///
/// rows   of all runs, see SweepResults
SweepSummary write_summary(const SweepPlan& plan,
                           const core::Json& rows,
                           const std::string& folder);

/// The rows as text with commas between (RFC 4180); lists as JSON, null as nothing.
std::string csv_text(const core::Json& rows);

/// The columns that people look at first: number, values, a few scores, time and failures.
Table headline_table(const SweepSettings& sweep, const core::Json& rows);

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
std::map<std::string, nlos::Plot> plots_of(const SweepSettings& sweep, const core::Json& rows);

}  // namespace apps
