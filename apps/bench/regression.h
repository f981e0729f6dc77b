// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/output.h"
#include "renderer/core/settings/json_fwd.h"

#include <string>
#include <vector>

namespace apps {

/// A figure of a benchmark that differs between two runs.
struct BenchChange {
    std::string where;      ///< list and names of the row, such as `curves/path/samples=512`
    std::string quantity;   ///< name of the figure, such as `cpu_seconds`
    double before = 0.0;    ///< in the older run
    double now = 0.0;       ///< in this run
    bool is_worse = false;  ///< slower, larger, less accurate, or a target missed
};
NLOS_FIGURES(BenchChange, where, quantity, before, now, is_worse);

/// Two runs of a benchmark side by side.
struct BenchRegression {
    std::string program;               ///< of the older run
    std::string machine;               ///< of the older run
    std::vector<BenchChange> changes;  ///< worse ones first, then by size
    int num_alike = 0;                 ///< figures that are the same but for noise
    int num_missing = 0;               ///< rows of this run that the older one has not
};
NLOS_FIGURES(BenchRegression, program, machine, changes, num_alike, num_missing);

/// Finds what became slower, larger or less accurate between two JSON files of a benchmark, and
/// what became better: times by a quarter, memory and errors by a tenth, fractions by 0.02, targets
/// met or missed. Rows of lists are matched by their names, not by their places.
BenchRegression compare_benches(const core::Json& before, const core::Json& now);

}  // namespace apps
