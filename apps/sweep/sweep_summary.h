// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/tables.h"
#include "apps/sweep/sweep_plan.h"

#include <string>

namespace apps {

/// What stands at the end of a sweep.
struct SweepSummary {
    std::size_t num_failed = 0;
    bool has_plots = true;  ///< false: gnuplot is missing
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

}  // namespace apps
