// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings.h"

#include <string>

namespace apps {

/// The path of a benchmark's files in a folder, without extension; makes the folder.
/// throws   core::Error when it cannot be made
std::string result_stem(const std::string& folder, const std::string& name);

/// Writes STEM.json, with the program's version, and STEM.txt, and prints the table.
void write_tables(const std::string& stem, core::Json json, const std::string& table);

/// Says where the results are and, unless `has_plots`, that gnuplot was missing.
void report_results(const std::string& stem, bool has_plots);

}  // namespace apps
