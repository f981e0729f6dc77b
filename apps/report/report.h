// SPDX-License-Identifier: MIT
#pragma once

#include "apps/report/results_folder.h"

#include <string>

namespace apps {

/// One HTML page that holds everything it shows: style and pictures inline, no script, no other
/// file.
std::string render_report(const ResultsFolder& results);

/// Writes the page about a folder of captures, volumes, metrics and pictures.
///
/// folder        where the results lie
/// output_html   page to write; whole or not at all
/// throws        core::Error when the folder does not exist or holds no result, or for a bad target
void write_report(const std::string& folder, const std::string& output_html);

}  // namespace apps
