// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/output.h"

#include <string>
#include <vector>

namespace apps {

/// One line of the table: what was asked and what came out.
struct FitBenchRow {
    std::string name;
    std::string target;
    std::string ours;
    bool holds = false;
};

template <class Visitor>
void for_each_field(FitBenchRow& row, Visitor&& visit) {
    visit("name", row.name, "what was measured");
    visit("target", row.target, "what was asked");
    visit("ours", row.ours, "what came out");
    visit("holds", row.holds, "whether the target is met");
}

/// Time against error of one way to fit.
struct FitBenchPoint {
    std::string choice;
    double cpu_seconds = 0.0;
    double iterations = 0.0;
    double position_rms_m = 0.0;
    double rotation_rms_deg = 0.0;
};

template <class Visitor>
void for_each_field(FitBenchPoint& point, Visitor&& visit) {
    visit("choice", point.choice, "setting that was varied");
    visit("cpu_seconds", point.cpu_seconds, "CPU time per fit [s]");
    visit("iterations", point.iterations, "mean over fits");
    visit("position_rms_m", point.position_rms_m, "root mean square error [m]");
    visit("rotation_rms_deg", point.rotation_rms_deg, "root mean square error [deg]");
}

/// What `nlos bench fit` measured.
struct FitBench {
    std::vector<FitBenchRow> rows;
    std::vector<FitBenchPoint> points;
};

template <class Visitor>
void for_each_field(FitBench& bench, Visitor&& visit) {
    visit("rows", bench.rows, "targets");
    visit("points", bench.points, "speed against error");
}

/// Parts of the benchmark, in the order of its table.
const std::vector<std::string>& fit_bench_parts();

/// Measures fitting and calibration on simulated data, on one thread.
///
/// trials     fits per row; 30 give the figures of calib/README.md
/// parts      of fit_bench_parts(); empty: all
FitBench bench_fit(int trials,
                   const std::vector<std::string>& parts,
                   const core::Progress& progress);

/// Tables and plot of it.
BenchResult fit_result(const FitBench& bench);

}  // namespace apps
