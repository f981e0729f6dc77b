// SPDX-License-Identifier: MIT
#pragma once

#include "apps/report/results_folder.h"

#include <string>

namespace apps {

/// What `nlos report` and `nlos view` let users choose.
struct ReportOptions {
    double data_mb = 25.0;  ///< most that a page's views may take; see views_html()
    std::string scene;      ///< scene.json with the truth; empty: the one that the results name
};

/// One HTML page that holds everything it shows: style, pictures, data and scripts inline, no other
/// file.
///
/// limit_bytes   of the data of its views
std::string render_report(const ResultsFolder& results, double limit_bytes);

/// Writes the page about results; whole or not at all.
/// throws   core::Error for a bad target
void write_report(const std::string& output_html,
                  const ResultsFolder& results,
                  const ReportOptions& options);

}  // namespace apps
