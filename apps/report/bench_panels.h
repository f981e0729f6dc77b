// SPDX-License-Identifier: MIT
#pragma once

#include "apps/page/page_pictures.h"
#include "apps/report/result_panels.h"
#include "apps/tables/tables.h"
#include "renderer/core/settings/json_fwd.h"

#include <string>
#include <vector>

namespace apps {

/// A picture lying in the folder.
struct Figure {
    std::string file;
    std::string bytes;  ///< of a .png or .svg file
};

/// What a benchmark found, see bench/output.h.
struct BenchPanel {
    std::string file;
    std::vector<Fact> facts;
    std::vector<Table> tables;
    std::vector<Figure> figures;
};

/// Whether a JSON file is what a benchmark writes, see output.h.
bool is_bench(const core::Json& json);

/// Whether it holds several of them, which have files of their own beside it.
bool is_collection_of_benches(const core::Json& json);

/// A benchmark's facts and tables; its figures are still to be given to it.
///
/// path   of the JSON file
BenchPanel read_bench_panel(const std::string& path, const core::Json& json);

/// Moves figures whose names begin with a benchmark's to it, one format of each.
void give_figures_to_benches(std::vector<Figure>& figures, std::vector<BenchPanel>& benches);

/// A benchmark as HTML: what it ran on, short tables, plots, and long tables folded.
std::string bench_html(const BenchPanel& panel, PagePictures& pictures);

/// The table of hard cases as HTML.
///
/// cases   list of objects with `name`, `group`, `why`, `must_hold`, `worst`, `bound`,
///         `explanation`
std::string hard_cases_html(const core::Json& cases);

}  // namespace apps
