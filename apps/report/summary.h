// SPDX-License-Identifier: MIT
#pragma once

#include "apps/report/results_folder.h"

#include <string>

namespace apps {

/// What a page is about, in two sentences: what was measured and found, and what the page holds.
std::string summary_text(const ResultsFolder& results);

/// What the 3-D view shows.
std::string space_caption(const ResultsFolder& results);

}  // namespace apps
