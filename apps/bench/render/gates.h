// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/progress.h"
#include "renderer/core/settings.h"

#include <string>
#include <vector>

namespace apps {

/// How an estimator does at one gate, or over the histogram, in equal time.
struct GateBench {
    double gate_mm = 0.0;  ///< 0: the whole histogram
    std::string method;
    double rel_mse = 0.0;
    double gain = 0.0;
    double gain_sigma = 0.0;
    double trimmed_gain = 0.0;
};

template <class Visitor>
void for_each_field(GateBench& bench, Visitor&& visit) {
    visit("gate_mm", bench.gate_mm, "width of the gate in path length [mm]; 0: the histogram");
    visit("method", bench.method, "estimator");
    visit("rel_mse", bench.rel_mse, "relative MSE times CPU seconds");
    visit("gain", bench.gain, "that of path over it: how much better in equal time");
    visit("gain_sigma", bench.gain_sigma, "standard deviation of the gain");
    visit("trimmed_gain", bench.trimmed_gain, "the gain without the worst 0.2 % of values");
}

/// All gates of a scene, the histogram first, then by falling width.
struct GateTable {
    std::string scene;
    int max_bounces = 3;
    double center_m = 0.0;
    std::vector<GateBench> gates;
    /// Width at which `path` and `ellipsoidal` do equally well, on straight lines between the
    /// logarithms; 0 when one does better at all widths.
    double crossing_mm = 0.0;
};

template <class Visitor>
void for_each_field(GateTable& table, Visitor&& visit) {
    visit("scene", table.scene, "scene file");
    visit("max_bounces", table.max_bounces, "bounces");
    visit("center_m", table.center_m, "centre of the gates: half of the signal arrives before [m]");
    visit("gates", table.gates, "relative MSE in equal time");
    visit("crossing_mm",
          table.crossing_mm,
          "width at which path and ellipsoidal do equally well; 0: none [mm]");
}

/// What exclusion does to the noise of `ellipsoidal`.
struct ExclusionBench {
    std::string scene;
    std::string mode;
    int max_bounces = 3;
    double gate_mm = 0.0;
    double center_m = 0.0;
    double variance_seconds = 0.0;  ///< relative to the squared signal
    double gain = 0.0;
};

template <class Visitor>
void for_each_field(ExclusionBench& bench, Visitor&& visit) {
    visit("scene", bench.scene, "scene file");
    visit("mode", bench.mode, "what becomes of excluded surfaces");
    visit("max_bounces", bench.max_bounces, "bounces");
    visit("gate_mm", bench.gate_mm, "width of the gate in path length [mm]; 0: the histogram");
    visit("center_m", bench.center_m, "centre of the gate in path length [m]");
    visit("variance_seconds", bench.variance_seconds, "relative variance after one CPU second");
    visit("gain", bench.gain, "that of mode none over it");
}

/// Relative MSE in equal time at gates around the middle of the signal, on one thread: `path`,
/// `ellipsoidal`, and `restir` in frames that know nothing of each other. Errors are against two
/// independent long runs of `ellipsoidal` (their product has no bias from the references' noise).
///
/// max_bounces   0: as the scene says
/// repeats       seeds per figure
GateTable bench_gates(const std::string& scene_path,
                      int max_bounces,
                      int repeats,
                      const core::Progress& progress);

/// Variance per second of `ellipsoidal` with each mode of exclusion, for 3 and 5 bounces, on one
/// thread: histogram, a gate at the middle of the signal, and one at the middle of what comes by
/// way of surfaces that are not excluded. Variances are those between runs of the same samples,
/// each mode about its own mean: that of `drop` lacks a part.
///
/// repeats   runs per figure, 2 at least
std::vector<ExclusionBench> bench_exclusion(const std::string& scene_path, int repeats);

}  // namespace apps
