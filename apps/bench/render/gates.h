// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/output.h"
#include "renderer/core/progress.h"
#include "renderer/core/settings/json_fwd.h"

#include <string>
#include <vector>

namespace apps {

/// How an estimator does at one gate, or over the histogram, in equal time.
struct GateBench {
    double gate_mm = 0.0;       ///< 0: the whole histogram
    std::string method;         ///< estimator
    double rel_mse = 0.0;       ///< relative MSE times CPU seconds
    double gain = 0.0;          ///< that of path over it: how much better in equal time
    double gain_sigma = 0.0;    ///< standard deviation of the gain
    double trimmed_gain = 0.0;  ///< the gain without the worst 0.2 % of values
};
NLOS_FIGURES(GateBench, gate_mm, method, rel_mse, gain, gain_sigma, trimmed_gain);

/// All gates of a scene, the histogram first, then by falling width.
struct GateTable {
    std::string scene;             ///< scene file
    int max_bounces = 3;           ///< bounces
    double center_m = 0.0;         ///< centre of the gates: half of the signal arrives before [m]
    std::vector<GateBench> gates;  ///< relative MSE in equal time
    /// Width at which `path` and `ellipsoidal` do equally well, on straight lines between the
    /// logarithms; 0 when one does better at all widths.
    double crossing_mm = 0.0;
};
NLOS_FIGURES(GateTable, scene, max_bounces, center_m, gates, crossing_mm);

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
/// rows      gets a row per mode, number of bounces and gate
void bench_exclusion(const std::string& scene_path, int repeats, core::Json& rows);

}  // namespace apps
