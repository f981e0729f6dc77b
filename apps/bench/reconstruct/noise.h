// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/figures.h"
#include "apps/bench/output.h"

#include <string>
#include <vector>

namespace apps {

/// How well one method reconstructs at one noise level; means over the seeds.
struct NoiseScore {
    double peak_counts = 0.0;    ///< expected counts in the brightest bin
    double depth_mae_m = 0.0;    ///< mean absolute depth error [m]
    double mask_iou = 0.0;       ///< overlap of the masks at 20 % of the maximum
    double mask_iou_best = 0.0;  ///< the same at the best threshold
};
NLOS_FIGURES(NoiseScore, peak_counts, depth_mae_m, mask_iou, mask_iou_best);

struct NoiseCurve {
    std::string method;              ///< method and prior
    std::vector<NoiseScore> scores;  ///< by rising light
};
NLOS_FIGURES(NoiseCurve, method, scores);

/// The Wiener filter's ratio chosen from the data against the best of a search.
struct SnrSearch {
    double peak_counts = 0.0;         ///< expected counts in the brightest bin
    double snr = 0.0;                 ///< chosen from the data
    double depth_mae_m = 0.0;         ///< depth error with it [m]
    double mask_iou_best = 0.0;       ///< overlap with it
    double best_mae_snr = 0.0;        ///< of those tried, the one of least depth error
    double best_depth_mae_m = 0.0;    ///< depth error with that [m]
    double best_iou_snr = 0.0;        ///< of those tried, the one of largest overlap
    double best_mask_iou_best = 0.0;  ///< overlap with that
};
NLOS_FIGURES(SnrSearch,
             peak_counts,
             snr,
             depth_mae_m,
             mask_iou_best,
             best_mae_snr,
             best_depth_mae_m,
             best_iou_snr,
             best_mask_iou_best);

struct NoiseBench {
    std::string scene;                ///< scene file
    int repeats = 1;                  ///< seeds per figure
    std::vector<NoiseCurve> curves;   ///< every method
    std::vector<SnrSearch> searches;  ///< regularisation of lct
};
NLOS_FIGURES(NoiseBench, scene, repeats, curves, searches);

/// What `nlos bench noise` is to measure.
struct NoiseBenchSettings {
    std::string scene = "scenes/bars/scene.json";  ///< a confocal scan of a planar grid
    int repeats = 1;                               ///< seeds per figure
};

/// Reconstructs a scene from 1 to 1000 counts in the brightest bin by every method, each with the
/// settings it chooses itself, and scores it against the truth.
BenchResult measure_noise(const NoiseBenchSettings& settings, const core::Progress& progress);

}  // namespace apps
