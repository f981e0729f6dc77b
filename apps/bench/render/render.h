// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/output.h"
#include "renderer/core/settings/json_fwd.h"

#include <string>
#include <vector>

namespace apps {

/// One run of an estimator.
struct BenchPoint {
    std::string effort;          ///< "samples=64", "target_error=0.01"
    int samples = 0;             ///< 0: the method takes none
    int runs = 1;                ///< that were made
    double cpu_seconds = 0.0;    ///< median over repeats
    double cpu_spread = 0.0;     ///< largest minus smallest
    double rel_l2 = 0.0;         ///< against the reference, root mean square over repeats
    double rel_l2_spread = 0.0;  ///< largest minus smallest error
    bool is_on_front = false;    ///< no other run is faster and more accurate
};
NLOS_FIGURES(
    BenchPoint, effort, samples, runs, cpu_seconds, cpu_spread, rel_l2, rel_l2_spread, is_on_front);

/// Error against time of one estimator and the line error = coefficient * seconds^slope.
struct BenchCurve {
    std::string method;              ///< estimator
    std::vector<BenchPoint> points;  ///< runs
    double slope = 0.0;              ///< of log error against log time; Monte Carlo has -0.5
    double coefficient = 0.0;        ///< error after one CPU second on the fitted line
};
NLOS_FIGURES(BenchCurve, method, points, slope, coefficient);

/// What one estimator costs at growing size of one kind, all else equal.
struct RenderScaling {
    std::string method;                 ///< estimator
    std::string of;                     ///< what grows
    std::vector<double> sizes;          ///< sizes
    std::vector<double> cpu_seconds;    ///< CPU time at each, with threads elapsed time [s]
    std::vector<double> limit_seconds;  ///< that of as many shadow rays alone; with threads the
                                        ///< first time over their number [s]
    std::vector<double> peak_bytes;     ///< largest memory of the process at each [B]
    double exponent = 0.0;  ///< time grows with this power of the size, fitted to all points
    double last = 0.0;      ///< the same between the two largest sizes
};
NLOS_FIGURES(
    RenderScaling, method, of, sizes, cpu_seconds, limit_seconds, peak_bytes, exponent, last);

/// Scaling of `third_bounce` (to 2 %) and of `path` (256 samples per pair) with triangles (512 to
/// 500,000), wall points, bins, bounces (`path` and `restir` on shared points) and threads (all
/// three): a wavy sheet of 0.8 m, 1 m behind a wall of 1 m, confocal. One thread but for the last.
std::vector<RenderScaling> bench_render_scaling(const core::Progress& progress);

/// What `nlos bench render` is to measure.
struct RenderBenchSettings {
    std::string scene = "scenes/bars/scene.json";
    std::string part = "all";  ///< or curves, third_bounce, accuracy, gates, exclusion, scaling
    int repeats = 3;           ///< runs per point; those that take long are not repeated
    bool quick = false;        ///< leaves out what takes longest

    bool has(const std::string& name) const { return part == "all" || part == name; }
};

/// Error against time of every estimator on a scene, on one thread.
///
/// figures   gets `curves`, `equal_error`, and how the reference was made and checked
/// returns   the curves
std::vector<BenchCurve> measure_curves(const RenderBenchSettings& settings,
                                       const core::Progress& progress,
                                       core::Json& figures);

/// Measures every estimator on a scene at several efforts, and the rest, on one thread: tables,
/// with what was asked of the figures, and plots.
BenchResult measure_render(const RenderBenchSettings& settings, const core::Progress& progress);

}  // namespace apps
