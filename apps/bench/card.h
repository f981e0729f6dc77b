// SPDX-License-Identifier: MIT
#pragma once

#include "apps/results_folder.h"

#include <string>

namespace apps {

/// Whether a JSON file is what a benchmark writes, see output.h.
bool is_bench(const core::Json& json);

/// Whether it holds several of them, which have files of their own beside it.
bool is_collection_of_benches(const core::Json& json);

/// A benchmark's facts and table; its figures are still to be given to it.
///
/// path   of the JSON file; the table lies beside it
BenchCard read_bench_card(const std::string& path, const core::Json& json);

/// Moves figures whose names begin with a benchmark's to it, one format of each.
void give_figures_to_benches(ResultsFolder& results);

/// The benchmarks as HTML: what they ran on, plots, table.
std::string benches_html(const std::vector<BenchCard>& benches);

/// The table of hard cases as HTML.
///
/// cases   list of objects with `name`, `group`, `why`, `must_hold`, `worst`, `bound`,
///         `explanation`
std::string hard_cases_html(const core::Json& cases);

}  // namespace apps
