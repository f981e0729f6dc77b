// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/output.h"

#include <string>
#include <vector>

namespace apps {

/// What one method costs on one capture: medians over the repeats.
struct ReconstructCost {
    std::string name;  ///< method and capture
    double cpu_seconds = 0.0;
    double seconds = 0.0;
    double limit_seconds = 0.0;  ///< CPU time of its FFTs or multiply-adds alone; 0: not measured
    double ratio = 0.0;          ///< of cpu_seconds to limit_seconds
    double gpairs_per_s = 0.0;   ///< backprojection: pairs times voxels; 0: not counted
    double peak_bytes = 0.0;     ///< resident, of the whole process
    double stated_bytes = 0.0;   ///< what reconstruct() announced
    std::string target;
    std::string met;  ///< yes, no, or empty without a target
};

template <class Visitor>
void for_each_field(ReconstructCost& cost, Visitor&& visit) {
    visit("name", cost.name, "method and capture");
    visit("cpu_seconds", cost.cpu_seconds, "CPU time [s]");
    visit("seconds", cost.seconds, "wall-clock time [s]");
    visit("limit_seconds", cost.limit_seconds, "CPU time of its FFTs or multiply-adds alone [s]");
    visit("ratio", cost.ratio, "of the two CPU times");
    visit("gpairs_per_s", cost.gpairs_per_s, "1e9 pairs of histogram and voxel per CPU second");
    visit("peak_bytes", cost.peak_bytes, "largest resident memory of the process [bytes]");
    visit("stated_bytes", cost.stated_bytes, "memory announced before the run [bytes]");
    visit("target", cost.target, "what was asked");
    visit("met", cost.met, "whether it holds");
}

/// How well one method does on one capture.
struct ReconstructAccuracy {
    std::string scene;
    std::string method;
    double depth_mae_m = 0.0;
    double depth_median_m = 0.0;
    double depth_rmse_m = 0.0;
    double mask_iou = 0.0;
    double mask_iou_best = 0.0;
    double normal_median_deg = 0.0;
    double cpu_seconds = 0.0;
    std::string target;
    std::string met;
};

template <class Visitor>
void for_each_field(ReconstructAccuracy& row, Visitor&& visit) {
    visit("scene", row.scene, "scene and noise");
    visit("method", row.method, "method and prior");
    visit("depth_mae_m", row.depth_mae_m, "mean absolute depth error [m]");
    visit("depth_median_m", row.depth_median_m, "median absolute depth error [m]");
    visit("depth_rmse_m", row.depth_rmse_m, "root mean square depth error [m]");
    visit("mask_iou", row.mask_iou, "overlap of the masks at 20 % of the maximum");
    visit("mask_iou_best", row.mask_iou_best, "the same at the best threshold");
    visit("normal_median_deg", row.normal_median_deg, "median angle between normals [deg]");
    visit("cpu_seconds", row.cpu_seconds, "CPU time [s]");
    visit("target", row.target, "what was asked");
    visit("met", row.met, "whether it holds");
}

/// One size of a scaling curve.
struct ScalingPoint {
    std::string size;
    double values = 0.0;  ///< of what grows
    double cpu_seconds = 0.0;
    double limit_seconds = 0.0;  ///< CPU time of its FFTs or multiply-adds alone
    double bytes = 0.0;
};

template <class Visitor>
void for_each_field(ScalingPoint& point, Visitor&& visit) {
    visit("size", point.size, "wall points x bins, or voxels");
    visit("values", point.values, "their number");
    visit("cpu_seconds", point.cpu_seconds, "CPU time [s]");
    visit("limit_seconds", point.limit_seconds, "CPU time of its FFTs or multiply-adds alone [s]");
    visit("bytes", point.bytes, "memory on top of the capture [bytes]");
}

/// Time and memory against a size, both proportional to values^exponent.
struct ReconstructScaling {
    std::string method;
    std::string of;  ///< what grows: values of the capture, or voxels
    std::vector<ScalingPoint> points;
    double time_exponent = 0.0;
    double memory_exponent = 0.0;
};

template <class Visitor>
void for_each_field(ReconstructScaling& scaling, Visitor&& visit) {
    visit("method", scaling.method, "method");
    visit("of", scaling.of, "what grows");
    visit("points", scaling.points, "by rising size");
    visit("time_exponent", scaling.time_exponent, "of their number");
    visit("memory_exponent", scaling.memory_exponent, "of their number");
}

struct ReconstructBench {
    int threads = 1;
    int repeats = 1;
    std::vector<ReconstructCost> costs;
    std::vector<ReconstructAccuracy> accuracies;
    std::vector<ReconstructScaling> scaling;
};

template <class Visitor>
void for_each_field(ReconstructBench& bench, Visitor&& visit) {
    visit("threads", bench.threads, "threads of everything that was timed");
    visit("repeats", bench.repeats, "runs per median");
    visit("costs", bench.costs, "time against limits, memory");
    visit("accuracies", bench.accuracies, "against the truth");
    visit("scaling", bench.scaling, "with size");
}

/// What `nlos bench reconstruct` is to do.
struct ReconstructBenchSettings {
    std::string scenes_folder = "scenes";
    std::string part = "all";  ///< or time, accuracy, scaling
    std::string capture;       ///< of the letter T from elsewhere, see letter.h; empty: none
    int repeats = 3;
    int threads = 1;
    int largest = 256;  ///< wall points along a side in the scaling curves
};

/// Every method's time against the FFTs or multiply-adds it cannot do without, and its memory.
std::vector<ReconstructCost> measure_costs(const ReconstructBenchSettings& settings,
                                           const core::Progress& progress);

/// Every method on the letter T and the project's scenes.
std::vector<ReconstructAccuracy> measure_accuracies(const ReconstructBenchSettings& settings,
                                                    const core::Progress& progress);

/// Time and memory for rising sizes of a confocal capture, and of the volume made from one.
std::vector<ReconstructScaling> measure_scaling(const ReconstructBenchSettings& settings,
                                                const core::Progress& progress);

/// All three.
///
/// throws   core::Error when a scene or the capture cannot be read
ReconstructBench bench_reconstruct(const ReconstructBenchSettings& settings,
                                   const core::Progress& progress);

/// Tables and plots of it.
BenchResult reconstruct_result(const ReconstructBench& bench);

}  // namespace apps
