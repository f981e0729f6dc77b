// SPDX-License-Identifier: MIT
#pragma once

#include "apps/report/results_folder.h"

#include <string>
#include <vector>

namespace apps {

/// An HTML table with one row per metric that any result has and one column per result, in units
/// that people read; the best value of each row is marked.
std::string metrics_table(const std::vector<ScoredResult>& scores);

/// A few headline figures: the best value of the most telling metrics and which result has it.
std::string metrics_tiles(const std::vector<ScoredResult>& scores);

}  // namespace apps
