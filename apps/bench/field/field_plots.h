// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/field/reconstruction_table.h"
#include "apps/bench/field/rendering_table.h"
#include "apps/bench/gnuplot.h"

#include <map>
#include <string>
#include <vector>

namespace apps {

/// Depth error against CPU time and against counts per point, for either pattern, by the end of
/// the pictures' names.
std::map<std::string, Plot> reconstruction_plots(
    const std::vector<ReconstructionSummary>& summaries);

/// Error against CPU time for every scene and order, likewise.
std::map<std::string, Plot> rendering_plots(const std::vector<RenderingRow>& rows);

}  // namespace apps
