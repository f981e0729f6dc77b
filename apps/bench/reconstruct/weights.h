// SPDX-License-Identifier: MIT
#pragma once

#include "apps/bench/figures.h"
#include "apps/bench/output.h"

#include <string>
#include <vector>

namespace apps {

/// The weight of total variation that the solver takes by itself, against the best of a search.
struct WeightSearch {
    double peak_counts = 0.0;      ///< expected counts in the brightest bin; 0: radiance
    double observed = 1.0;         ///< share of the wall points that were observed
    int captures = 0;              ///< random surfaces
    double found = 0.0;            ///< share of true columns given a depth by default
    double depth_mae_m = 0.0;      ///< mean error of these depths [m]
    double best_weight = 0.0;      ///< of those tried, the one of least error
    double best_found = 0.0;       ///< as `found`, with it
    double error_over_best = 0.0;  ///< the default's mean error over the best weight's, over the
                                   ///< columns that both found
};
NLOS_FIGURES(WeightSearch,
             peak_counts,
             observed,
             captures,
             found,
             depth_mae_m,
             best_weight,
             best_found,
             error_over_best);

struct WeightsBench {
    std::vector<WeightSearch> searches;
};
NLOS_FIGURES(WeightsBench, searches);

/// What `nlos bench weights` is to measure.
struct WeightsBenchSettings {
    int surfaces = 20;  ///< each at every signal level
    int first = 3000;   ///< number of the first
    std::string pattern = "confocal";
    std::vector<double> peaks{0.0, 1000.0, 100.0, 20.0, 3.0};
    std::vector<double> observed{1.0, 0.0625};
    std::vector<double> weights{0.0875, 0.175, 0.35, 0.7, 1.4, 2.8, 5.6};
};

/// Reconstructs random surfaces with the weight that the solver takes by itself and with others.
WeightsBench search_weights(const WeightsBenchSettings& settings, const core::Progress& progress);

}  // namespace apps
