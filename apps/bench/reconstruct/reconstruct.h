// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/figures.h"
#include "apps/bench/output.h"

#include <string>
#include <vector>

namespace apps {

/// What one method costs on one capture: medians over the repeats.
struct ReconstructCost {
    std::string name;            ///< method and capture
    double cpu_seconds = 0.0;    ///< CPU time [s]
    double seconds = 0.0;        ///< wall-clock time [s]
    double limit_seconds = 0.0;  ///< CPU time of its FFTs or multiply-adds alone; 0: not measured
    double ratio = 0.0;          ///< of cpu_seconds to limit_seconds
    double gpairs_per_s = 0.0;   ///< backprojection: pairs times voxels; 0: not counted
    double peak_bytes = 0.0;     ///< resident, of the whole process
    double stated_bytes = 0.0;   ///< what reconstruct() announced
    std::string target;          ///< what was asked
    std::string met;             ///< yes, no, or empty without a target
};
NLOS_FIGURES(ReconstructCost,
             name,
             cpu_seconds,
             seconds,
             limit_seconds,
             ratio,
             gpairs_per_s,
             peak_bytes,
             stated_bytes,
             target,
             met);

/// How well one method does on one capture.
struct ReconstructAccuracy {
    std::string scene;               ///< scene and noise
    std::string method;              ///< method and prior
    double depth_mae_m = 0.0;        ///< mean absolute depth error [m]
    double depth_median_m = 0.0;     ///< median absolute depth error [m]
    double depth_rmse_m = 0.0;       ///< root mean square depth error [m]
    double mask_iou = 0.0;           ///< overlap of the masks at 20 % of the maximum
    double mask_iou_best = 0.0;      ///< the same at the best threshold
    double normal_median_deg = 0.0;  ///< median angle between normals [deg]
    double cpu_seconds = 0.0;        ///< CPU time [s]
    std::string target;              ///< what was asked
    std::string met;                 ///< whether it holds
};
NLOS_FIGURES(ReconstructAccuracy,
             scene,
             method,
             depth_mae_m,
             depth_median_m,
             depth_rmse_m,
             mask_iou,
             mask_iou_best,
             normal_median_deg,
             cpu_seconds,
             target,
             met);

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

struct ReconstructBench {
    int threads = 1;                              ///< threads of everything that was timed
    int repeats = 1;                              ///< runs per median
    std::vector<ReconstructCost> costs;           ///< time against limits, memory
    std::vector<ReconstructAccuracy> accuracies;  ///< against the truth
    std::vector<ReconstructScaling> scaling;      ///< with size
};
NLOS_FIGURES(ReconstructBench, threads, repeats, costs, accuracies, scaling);

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

/// All three, as tables and plots.
///
/// throws   core::Error when a scene or the capture cannot be read
BenchResult measure_reconstruct(const ReconstructBenchSettings& settings,
                                const core::Progress& progress);

}  // namespace apps
