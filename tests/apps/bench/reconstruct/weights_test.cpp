// SPDX-License-Identifier: MIT
// What `nlos bench weights` measures, on fewer surfaces and weights.
#include "apps/bench/reconstruct/weights.h"

#include <gtest/gtest.h>

namespace apps {
namespace {

// The design asks for at most 15 % above the best of a search. The surfaces are few, and the best
// of these weights is the best of their noise too: 5 % more.
TEST(Weights, TakenByTheSolverAreNearTheBestOfASearch) {
    WeightsBenchSettings settings;
    settings.surfaces = 3;
    settings.peaks = {0.0, 20.0};
    settings.observed = {1.0};
    settings.weights = {0.25, 0.7, 1.5};
    const WeightsBench bench = search_weights(settings, {});
    ASSERT_EQ(bench.searches.size(), 2U);
    for (const WeightSearch& search : bench.searches) {
        EXPECT_GE(search.error_over_best, 0.8) << search.peak_counts;
        EXPECT_LE(search.error_over_best, 1.2) << search.peak_counts;
        EXPECT_GE(search.found, 0.9) << search.peak_counts;
        EXPECT_GE(search.found, 0.85 * search.best_found);
    }
}

}  // namespace
}  // namespace apps
