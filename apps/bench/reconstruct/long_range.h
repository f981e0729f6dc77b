// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/figures.h"
#include "renderer/core/progress.h"

#include <optional>
#include <string>
#include <vector>

namespace apps {

/// How well one method reads a letter from afar.
struct LongRangeScore {
    double photons_per_point = 0.0;
    double spot_m = 0.0;  ///< full width at half maximum on the wall
    std::string method;
    double mask_iou_stated = 0.0;       ///< overlap of the columns that were given a depth
    double mask_iou_best = 0.0;         ///< overlap at the best threshold
    std::optional<double> depth_mae_m;  ///< mean absolute depth error [m]
    double seconds = 0.0;
};
NLOS_FIGURES(LongRangeScore,
             photons_per_point,
             spot_m,
             method,
             mask_iou_stated,
             mask_iou_best,
             depth_mae_m,
             seconds);

struct LongRangeBench {
    std::vector<LongRangeScore> scores;
};
NLOS_FIGURES(LongRangeBench, scores);

/// What `nlos bench long_range` is to measure.
struct LongRangeBenchSettings {
    std::vector<double> photons{1000.0, 5000.0, 100000.0};
    std::vector<double> spots_m{0.08, 0.14};
    std::vector<std::string> methods{"lct", "fk", "phasor", "solver"};
};

/// Reconstructs the letter H with strokes of 4 cm, 0.6 m before a wall of 0.9 m, from what a set-up
/// for ranges of kilometres gets of it: a response of 794 ps, a spot on the wall wider than the
/// strokes, and a gate of 120 bins of 32 ps. Of the set-up of [Wu2021] in its numbers alone.
LongRangeBench measure_long_range(const LongRangeBenchSettings& settings,
                                  const core::Progress& progress);

}  // namespace apps
