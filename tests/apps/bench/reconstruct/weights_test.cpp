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
    settings.surfaces = 6;
    settings.peaks = {0.0, 20.0};
    settings.weights = {0.175, 0.35, 0.7, 1.4};
    const WeightsBench bench = search_weights(settings, {});
    ASSERT_EQ(bench.searches.size(), 4U);
    for (const WeightSearch& search : bench.searches) {
        EXPECT_GE(search.error_over_best, 0.8) << search.peak_counts << " " << search.observed;
        EXPECT_LE(search.error_over_best, 1.2) << search.peak_counts << " " << search.observed;
        EXPECT_GE(search.found, search.observed < 1.0 ? 0.6 : 0.9);
        EXPECT_GE(search.found, 0.85 * search.best_found);
    }
}

}  // namespace
}  // namespace apps
