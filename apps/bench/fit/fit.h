// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/output.h"

#include <string>
#include <vector>

namespace apps {

/// What `nlos bench fit` is to measure.
struct FitBenchSettings {
    int trials = 30;                 ///< fits per row
    std::vector<std::string> parts;  ///< of fit_bench_parts(); empty: all
};

/// Parts of the benchmark, in the order of its table.
std::vector<std::string> fit_bench_parts();

/// Measures fitting and calibration on simulated data, on one thread.
BenchResult measure_fit(const FitBenchSettings& settings, const core::Progress& progress);

}  // namespace apps
