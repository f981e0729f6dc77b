// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/output.h"
#include "apps/bench/render/gates.h"
#include "apps/bench/render/scaling.h"
#include "apps/bench/render/third_bounce_accuracy.h"
#include "apps/bench/render/third_bounce_costs.h"

#include <string>
#include <vector>

namespace apps {

/// One run of an estimator.
struct BenchPoint {
    std::string effort;        ///< "samples=64", "target_error=0.01"
    int samples = 0;           ///< 0: the method takes none
    int runs = 1;              ///< that were made
    double cpu_seconds = 0.0;  ///< median over repeats
    double cpu_spread = 0.0;   ///< largest minus smallest
    double rel_l2 = 0.0;       ///< against the reference, root mean square over repeats
    double rel_l2_spread = 0.0;
    bool is_on_front = false;  ///< no other run is faster and more accurate
};

template <class Visitor>
void for_each_field(BenchPoint& point, Visitor&& visit) {
    visit("effort", point.effort, "setting that was varied");
    visit("samples", point.samples, "per pair; 0: the method takes none");
    visit("runs", point.runs, "runs that were made");
    visit("cpu_seconds", point.cpu_seconds, "CPU time, median over repeats [s]");
    visit("cpu_spread", point.cpu_spread, "largest minus smallest CPU time [s]");
    visit("rel_l2", point.rel_l2, "relative L2 error over all of H");
    visit("rel_l2_spread", point.rel_l2_spread, "largest minus smallest error");
    visit("is_on_front", point.is_on_front, "no other run is faster and more accurate");
}

/// Error against time of one estimator and the line error = coefficient * seconds^slope.
struct BenchCurve {
    std::string method;
    std::vector<BenchPoint> points;
    double slope = 0.0;
    double coefficient = 0.0;
};

template <class Visitor>
void for_each_field(BenchCurve& curve, Visitor&& visit) {
    visit("method", curve.method, "estimator");
    visit("points", curve.points, "runs");
    visit("slope", curve.slope, "of log error against log time; Monte Carlo has -0.5");
    visit("coefficient", curve.coefficient, "error after one CPU second on the fitted line");
}

/// One estimator against `path`, which is continued along its fitted line.
struct EqualError {
    std::string method;
    double at_rel_l2 = 0.0;
    double cpu_seconds = 0.0;  ///< see seconds_to() in render.cpp
    double path_seconds = 0.0;
    double time_ratio = 0.0;   ///< of path's time to the method's, at this error
    double error_ratio = 0.0;  ///< of path's error to this one, at the method's time
};

template <class Visitor>
void for_each_field(EqualError& equal, Visitor&& visit) {
    visit("method", equal.method, "estimator");
    visit("at_rel_l2", equal.at_rel_l2, "relative L2 error");
    visit("cpu_seconds", equal.cpu_seconds, "CPU time of the method [s]");
    visit("path_seconds", equal.path_seconds, "CPU time of path, on its fitted line [s]");
    visit("time_ratio", equal.time_ratio, "of path's time to the method's at this error");
    visit("error_ratio", equal.error_ratio, "of path's error to this one at the method's time");
}

/// What `nlos bench render` measured.
struct RenderBench {
    std::string scene;
    std::string reference;        ///< how the reference was made
    double check_distance = 0.0;  ///< relative L2 distance of a long run of path from it
    double check_noise = 0.0;     ///< the noise of that run
    int repeats = 0;
    double ray_limit_seconds = 0.0;  ///< CPU time of the shadow rays of `path`, per sample
    std::vector<BenchCurve> curves;
    std::vector<EqualError> equal_error;
    std::vector<ThirdBounceCost> third_bounce;
    std::vector<TargetError> target_errors;
    std::vector<Agreement> agreement;
    std::vector<GateTable> gates;
    std::vector<ExclusionBench> exclusion;
    std::vector<RenderScaling> scaling;
};

template <class Visitor>
void for_each_field(RenderBench& bench, Visitor&& visit) {
    visit("scene", bench.scene, "scene file");
    visit("reference", bench.reference, "how the reference was made");
    visit("check_distance", bench.check_distance, "distance of a long run of path from it");
    visit("check_noise", bench.check_noise, "noise of that run");
    visit("repeats", bench.repeats, "runs per point");
    visit("ray_limit_seconds",
          bench.ray_limit_seconds,
          "CPU time of the shadow rays alone per sample of all pairs [s]");
    visit("curves", bench.curves, "error against time");
    visit("equal_error", bench.equal_error, "every estimator against path");
    visit("third_bounce", bench.third_bounce, "histogram, gates and pairs to 1 %");
    visit("target_errors", bench.target_errors, "of third_bounce on random scenes");
    visit("agreement", bench.agreement, "of third_bounce and path bin by bin");
    visit("gates", bench.gates, "every estimator in equal time");
    visit("exclusion", bench.exclusion, "ellipsoidal with and without excluded surfaces");
    visit("scaling", bench.scaling, "time against sizes");
}

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

/// Tables and plots of it.
BenchResult render_result(const RenderBench& bench);

}  // namespace apps
