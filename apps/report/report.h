// SPDX-License-Identifier: MIT
#pragma once

#include "apps/report/results_folder.h"

#include <string>

namespace apps {

/// What `nlos report` and `nlos view` let users choose.
struct ReportOptions {
    double data_mb = 25.0;  ///< most that a page takes beside its style sheet and scripts
    std::string scene;      ///< scene.json with the truth; empty: the one that the results name
};

/// One HTML page that holds everything it shows: style, pictures, data and scripts inline, no other
/// file. It is valid UTF-8 whatever the results' files are called.
struct Report {
    std::string html;
    std::string reductions;  ///< what the page says it does not show as it is; empty: nothing
};

/// Makes the page about results.
///
/// limit_bytes   of all that grows with the results; style sheet and scripts are another 1 MB.
///               What does not fit is coarser, a thumbnail, or named only, see fit_page()
Report render_report(const ResultsFolder& results, double limit_bytes);

/// Writes the page about results; whole or not at all.
/// returns  Report::reductions
/// throws   core::Error for a bad target
std::string write_report(const std::string& output_html,
                         const ResultsFolder& results,
                         const ReportOptions& options);

}  // namespace apps
