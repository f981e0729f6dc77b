// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/output.h"

#include <cstdint>
#include <string>

namespace apps {

/// What `nlos bench regret` is to measure.
struct RegretBenchSettings {
    int jobs = 40;
    int seed = 0;               ///< of the drawing of jobs
    double most_seconds = 4.0;  ///< CPU time that `auto` may take to a job's error, about
};

/// What `auto` did in one job, and the best of the other estimators.
struct RegretRow {
    std::string scene;          ///< a scene of scenes/, or one made for the benchmark
    std::string pattern;        ///< what is scanned
    double gate_mm = 0.0;       ///< width in path length; 0: the whole histogram
    std::string gate_at;        ///< "early" or "late" in the light
    int max_bounces = 3;        ///< bounces
    double target_error = 0.0;  ///< relative L2 asked for
    double error = 0.0;         ///< that `auto` reached
    double cpu_seconds = 0.0;   ///< that it took
    std::string chose;          ///< estimators that it used
    std::string best;           ///< the fastest other one to the error asked for
    double best_seconds = 0.0;  ///< its CPU time to that error
    double regret = 0.0;        ///< CPU time of `auto` to that error over that
};
NLOS_FIGURES(RegretRow,
             scene,
             pattern,
             gate_mm,
             gate_at,
             max_bounces,
             target_error,
             error,
             cpu_seconds,
             chose,
             best,
             best_seconds,
             regret);

/// How much longer `auto` takes than the best estimator, on one thread, over jobs drawn at random:
/// scene, pattern, whole histogram or a gate of 1 to 100 mm early or late in the light, up to 3, 5
/// or 8 bounces, an error of 5, 1 or 0.3 %. A job that takes `auto` too long gets the next larger
/// error.
///
/// All are asked for that error; others are stopped after three times what `auto` took. Errors are
/// those really reached, against two independent references. From them the time to the error asked
/// for follows by the inverse square that sampling has. Times below 50 ms count as that.
BenchResult measure_regret(const RegretBenchSettings& settings, const core::Progress& progress);

}  // namespace apps
