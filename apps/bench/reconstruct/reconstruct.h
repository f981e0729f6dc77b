// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/output.h"
#include "renderer/core/settings/json_fwd.h"

#include <string>
#include <vector>

namespace apps {

/// One size of a scaling curve.
struct ScalingPoint {
    std::string size;            ///< wall points x bins, or voxels
    double values = 0.0;         ///< of what grows
    double cpu_seconds = 0.0;    ///< CPU time [s]
    double limit_seconds = 0.0;  ///< CPU time of its FFTs or multiply-adds alone
    double bytes = 0.0;          ///< memory on top of the capture [bytes]
};
NLOS_FIGURES(ScalingPoint, size, values, cpu_seconds, limit_seconds, bytes);

/// Time and memory against a size, both proportional to values^exponent.
struct ReconstructScaling {
    std::string method;                ///< method
    std::string of;                    ///< what grows: values of the capture, or voxels
    std::vector<ScalingPoint> points;  ///< by rising size
    double time_exponent = 0.0;        ///< of their number
    double memory_exponent = 0.0;      ///< of their number
};
NLOS_FIGURES(ReconstructScaling, method, of, points, time_exponent, memory_exponent);

/// What `nlos bench reconstruct` is to do.
struct ReconstructBenchSettings {
    std::string scenes_folder = "scenes";
    std::string part = "all";  ///< or time, accuracy, scaling
    int repeats = 3;
    int threads = 1;
    int largest = 256;  ///< wall points along a side in the scaling curves
};

/// Every method's time against the FFTs or multiply-adds it cannot do without, and its memory; a
/// row for every method and capture.
core::Json measure_costs(const ReconstructBenchSettings& settings, const core::Progress& progress);

/// Every method on the letter T and the project's scenes; a row for either.
core::Json measure_accuracies(const ReconstructBenchSettings& settings,
                              const core::Progress& progress);

/// Time and memory for rising sizes of a confocal capture, and of the volume made from one.
std::vector<ReconstructScaling> measure_scaling(const ReconstructBenchSettings& settings,
                                                const core::Progress& progress);

/// All three, as tables and plots.
///
/// throws   core::Error when a scene cannot be read
BenchResult measure_reconstruct(const ReconstructBenchSettings& settings,
                                const core::Progress& progress);

/// What `nlos bench coverage` is to measure.
struct CoverageBenchSettings {
    int surfaces = 60;  ///< each at every signal level
    int first = 1000;   ///< number of the first
    std::vector<std::string> methods{"lct", "dlct", "fk", "phasor", "fbp", "bp"};
    std::vector<double> peaks{3.0, 10.0, 20.0, 100.0, 1000.0};
};

/// Reconstructs random surfaces from counts and holds reported deviations and probabilities against
/// the truth: `depths` has a row per method and signal level, `probabilities` one per method and
/// tenth.
BenchResult measure_coverage(const CoverageBenchSettings& settings, const core::Progress& progress);

/// What `nlos bench weights` is to measure.
struct WeightsBenchSettings {
    int surfaces = 20;  ///< each at every signal level
    int first = 3000;   ///< number of the first
    std::vector<double> peaks{0.0, 1000.0, 100.0, 20.0, 3.0};
    std::vector<double> observed{1.0, 0.0625};
    std::vector<double> weights{0.0875, 0.175, 0.35, 0.7, 1.4, 2.8, 5.6};
};

/// Reconstructs random surfaces with the weight of total variation that the solver takes by itself
/// and with others: `searches` has a row per signal level and fraction of wall points.
BenchResult measure_weights(const WeightsBenchSettings& settings, const core::Progress& progress);

/// What `nlos bench long_range` is to measure.
struct LongRangeBenchSettings {
    std::vector<double> photons{1000.0, 5000.0, 100000.0};
    /// Full widths at half maximum [m]. A Gaussian spot of 0.14 m is 0.08 m wide by this measure
    /// when its diameter is where the power falls to 1/e^2, as is usual for laser beams.
    std::vector<double> spots_m{0.08, 0.14};
    std::vector<std::string> methods{"lct", "fk", "phasor", "solver"};
};

/// Reconstructs the letter H with strokes of 4 cm, 0.6 m before a wall of 0.9 m, from what a set-up
/// for ranges of kilometres gets of it: a response of 794 ps, a spot on the wall wider than the
/// strokes, and a gate of 120 bins of 32 ps. Of the set-up of [Wu2021] in its numbers alone.
/// `scores` has a row per spot, number of photons and method.
BenchResult measure_long_range(const LongRangeBenchSettings& settings,
                               const core::Progress& progress);

}  // namespace apps
