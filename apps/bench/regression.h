// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings.h"

#include <string>
#include <vector>

namespace apps {

/// A figure of a benchmark that differs between two runs.
struct BenchChange {
    std::string where;     ///< list and names of the row, such as `curves/path/samples=512`
    std::string quantity;  ///< name of the figure, such as `cpu_seconds`
    double before = 0.0;
    double now = 0.0;
    bool is_worse = false;
};

template <class Visitor>
void for_each_field(BenchChange& change, Visitor&& visit) {
    visit("where", change.where, "list and names of the row");
    visit("quantity", change.quantity, "name of the figure");
    visit("before", change.before, "in the older run");
    visit("now", change.now, "in this run");
    visit("is_worse", change.is_worse, "slower, larger, less accurate, or a target missed");
}

/// Two runs of a benchmark side by side.
struct BenchRegression {
    std::string program;  ///< of the older run
    std::string machine;  ///< of the older run
    std::vector<BenchChange> changes;
    int num_alike = 0;    ///< figures that are the same but for noise
    int num_missing = 0;  ///< rows of this run that the older one has not
};

template <class Visitor>
void for_each_field(BenchRegression& against, Visitor&& visit) {
    visit("program", against.program, "version of the older run");
    visit("machine", against.machine, "of the older run");
    visit("changes", against.changes, "worse ones first, then by size");
    visit("num_alike", against.num_alike, "figures that are the same but for noise");
    visit("num_missing", against.num_missing, "rows that the older run has not");
}

/// Finds what became slower, larger or less accurate between two JSON files of a benchmark, and
/// what became better: times by a quarter, memory and errors by a tenth, shares by 0.02, targets
/// met or missed. Rows of lists are matched by their names, not by their places.
BenchRegression compare_benches(const core::Json& before, const core::Json& now);

/// As a table for people.
std::string against_table(const BenchRegression& against);

}  // namespace apps
