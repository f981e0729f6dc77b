// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/figures.h"
#include "apps/bench/output.h"

namespace apps {

/// What `nlos bench track` is to measure.
struct TrackBenchSettings {
    int walks = 50;               ///< trajectories of each row
    int empty_walks = 20;         ///< of a scene without a target
    double systematic_m = 0.002;  ///< see calib::NoiseSettings
};

/// Tracks simulated walks and holds them against their truth, their stated covariance and the
/// recursive Cramer-Rao bound [Tichavsky1998], and measures speed on one core.
BenchResult measure_track(const TrackBenchSettings& settings, const core::Progress& progress);

}  // namespace apps
