// SPDX-License-Identifier: MIT
#pragma once

#include "apps/report/bench_panels.h"
#include "renderer/core/settings/json_file.h"

#include <string>
#include <vector>

namespace apps {

/// What a sweep over settings found, see sweep/sweep_summary.h.
struct SweepPanel {
    std::string file;
    core::Json content;
    std::vector<Figure> figures;
};

/// Whether a JSON file is what a sweep writes.
bool is_sweep(const core::Json& json);

/// Moves the figures that a sweep drew to it, one format of each.
void give_figures_to_sweeps(std::vector<Figure>& figures, std::vector<SweepPanel>& sweeps);

/// A sweep as HTML: plots, table, runs that failed.
std::string sweep_html(const SweepPanel& panel, PagePictures& pictures);

}  // namespace apps
