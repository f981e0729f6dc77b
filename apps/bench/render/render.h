// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/figures.h"
#include "apps/bench/output.h"
#include "apps/bench/render/gates.h"
#include "apps/bench/render/scaling.h"
#include "apps/bench/render/third_bounce.h"

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

/// One estimator against `path`, which is continued along its fitted line.
struct EqualError {
    std::string method;         ///< estimator
    double at_rel_l2 = 0.0;     ///< relative L2 error
    double cpu_seconds = 0.0;   ///< see seconds_to() in render.cpp
    double path_seconds = 0.0;  ///< CPU time of path, on its fitted line [s]
    double time_ratio = 0.0;    ///< of path's time to the method's, at this error
    double error_ratio = 0.0;   ///< of path's error to this one, at the method's time
};
NLOS_FIGURES(EqualError, method, at_rel_l2, cpu_seconds, path_seconds, time_ratio, error_ratio);

/// What `nlos bench render` measured.
struct RenderBench {
    std::string scene;                    ///< scene file
    std::string reference;                ///< how the reference was made
    double check_distance = 0.0;          ///< relative L2 distance of a long run of path from it
    double check_noise = 0.0;             ///< the noise of that run
    int repeats = 0;                      ///< runs per point
    double ray_limit_seconds = 0.0;       ///< CPU time of the shadow rays of `path`, per sample
    std::vector<BenchCurve> curves;       ///< error against time
    std::vector<EqualError> equal_error;  ///< every estimator against path
    std::vector<ThirdBounceCost> third_bounce;  ///< histogram, gates and pairs to 1 %
    std::vector<TargetError> target_errors;     ///< of third_bounce on random scenes
    std::vector<Agreement> agreement;           ///< of third_bounce and path bin by bin
    std::vector<GateTable> gates;               ///< every estimator in equal time
    std::vector<ExclusionBench> exclusion;      ///< ellipsoidal with and without excluded surfaces
    std::vector<RenderScaling> scaling;         ///< time against sizes
};
NLOS_FIGURES(RenderBench,
             scene,
             reference,
             check_distance,
             check_noise,
             repeats,
             ray_limit_seconds,
             curves,
             equal_error,
             third_bounce,
             target_errors,
             agreement,
             gates,
             exclusion,
             scaling);

/// What `nlos bench render` is to measure.
struct RenderBenchSettings {
    std::string scene = "scenes/bars/scene.json";
    std::string camera_scene = "scenes/box/scene.json";  ///< where gates are tried, too
    /// Where excluding surfaces from ellipsoidal connections is tried: a relay wall, a curved one,
    /// and a back wall with its neighbours.
    std::vector<std::string> exclusion_scenes = {
        "scenes/bars/scene.json", "scenes/curved/scene.json", "scenes/corner/scene.json"};
    /// Where third_bounce and path are compared bin by bin.
    std::vector<std::string> agreement_scenes = {"scenes/letter/scene.json",
                                                 "scenes/bars/scene.json",
                                                 "scenes/corner/scene.json",
                                                 "scenes/glossy/scene.json",
                                                 "scenes/animal/scene.json",
                                                 "scenes/curved/scene.json"};
    std::string part = "all";  ///< or curves, third_bounce, accuracy, gates, exclusion, scaling
    int repeats = 3;           ///< runs per point; those that take long are not repeated
    bool quick = false;        ///< leaves out what takes longest

    bool has(const std::string& name) const { return part == "all" || part == name; }
};

/// Measures every estimator on a scene at several efforts, and the rest, on one thread.
RenderBench bench_render(const RenderBenchSettings& settings, const core::Progress& progress);

/// The same as tables, with what was asked of the figures, and plots.
BenchResult measure_render(const RenderBenchSettings& settings, const core::Progress& progress);

}  // namespace apps
