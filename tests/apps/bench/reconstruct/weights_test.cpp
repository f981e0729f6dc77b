// SPDX-License-Identifier: MIT
// What `nlos bench weights` measures, on fewer surfaces and weights.
#include "apps/bench/reconstruct/reconstruct.h"
#include "renderer/core/settings/json_file.h"

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
    const core::Json searches = measure_weights(settings, {}).figures["searches"];
    ASSERT_EQ(searches.size(), 2U);
    for (const core::Json& search : searches) {
        const double found = search["found"];
        EXPECT_GE(search["error_over_best"].get<double>(), 0.8) << search;
        EXPECT_LE(search["error_over_best"].get<double>(), 1.2) << search;
        EXPECT_GE(found, 0.9) << search;
        EXPECT_GE(found, 0.85 * search["best_found"].get<double>());
    }
}

}  // namespace
}  // namespace apps
