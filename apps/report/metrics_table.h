// SPDX-License-Identifier: MIT
#pragma once

#include "apps/report/results_folder.h"

#include <string>
#include <vector>

namespace apps {

/// The results that can stand in one table: those whose F-scores have one threshold. Results
/// without any stand in the first.
std::vector<std::vector<ScoredResult>> groups_by_threshold(const std::vector<ScoredResult>& scores);

/// An HTML table with one row per result and one column per metric that any result has, in units
/// that people read; the best value of each column is marked. The page's script sorts it.
///
/// scores   at one threshold, see groups_by_threshold()
std::string metrics_table(const std::vector<ScoredResult>& scores);

/// Headline figures of the result with the highest F-score: what of the truth it found, what of it
/// is true, and its depth error with the fraction of the surface that this is of. Nothing without
/// F-scores.
std::string metrics_tiles(const std::vector<ScoredResult>& scores);

}  // namespace apps
