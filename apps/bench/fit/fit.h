// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/output.h"

#include <string>
#include <vector>

namespace apps {

/// What `nlos bench fit` is to measure.
struct FitBenchSettings {
    int trials = 30;                 ///< fits per row
    std::vector<std::string> parts;  ///< of the table, see fit.cpp; empty: all
};

/// Measures fitting and calibration on simulated data, on one thread.
BenchResult measure_fit(const FitBenchSettings& settings, const core::Progress& progress);

/// Time against error of one way to fit.
struct FitBenchPoint {
    std::string choice;             ///< setting that was varied
    double cpu_seconds = 0.0;       ///< CPU time per fit [s]
    double iterations = 0.0;        ///< mean over fits
    double position_rms_m = 0.0;    ///< root mean square error [m]
    double rotation_rms_deg = 0.0;  ///< root mean square error [deg]
};
NLOS_FIGURES(FitBenchPoint, choice, cpu_seconds, iterations, position_rms_m, rotation_rms_deg);

/// What `nlos bench fit` measured.
struct FitBench {
    std::vector<Target> rows;           ///< targets
    std::vector<FitBenchPoint> points;  ///< speed against error
};
NLOS_FIGURES(FitBench, rows, points);

inline constexpr double kMillimetre = 1e-3;  // in metres

/// How long the forward model takes.
void bench_forward(FitBench& bench);

/// Heights of a curved surface's vertices, 5 x 5 and 9 x 9 of them, from 1e6 photons.
void bench_heights(int trials, FitBench& bench);

/// Calibration from direct returns of a wall at 1 m, tilted by 30 degrees.
void bench_direct_returns(int trials, FitBench& bench);

}  // namespace apps
