// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/reconstruct.h"

#include <string>
#include <vector>

namespace apps {

using Overrides = std::vector<std::string>;  ///< `key.path=value` texts

/// The slices that the costs of methods are compared on.
inline const std::string kSlices = "volume.z_range_m=[0.45,1.05]";

/// Notes what is asked of a row of a table, unless nothing is, and whether it and all before hold.
template <class Row>
void judge(Row& row, bool is_asked, const std::string& text, bool is_met) {
    if (!is_asked) return;
    row.target += (row.target.empty() ? "" : ", ") + text;
    row.met = is_met && row.met != "no" ? "yes" : "no";
}

/// One reconstruction and what it took.
struct ReconstructRun {
    nlos::Reconstruction result;
    double cpu_seconds = 0.0;
    double bytes = 0.0;       ///< on top of what was held before
    double peak_bytes = 0.0;  ///< of the whole process
};

ReconstructRun run_reconstruction(const core::Capture& capture, const Overrides& overrides);

}  // namespace apps
