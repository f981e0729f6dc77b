// SPDX-License-Identifier: MIT
// What `nlos bench coverage` measures, on fewer surfaces.
#include "apps/bench/reconstruct/coverage.h"

#include <gtest/gtest.h>

namespace apps {
namespace {

TEST(Coverage, OfStatedDepthsIsThatOfTheirDeviations) {
    CoverageBenchSettings settings;
    settings.surfaces = 24;
    settings.first = 500;
    settings.methods = {"lct"};
    settings.peaks = {20.0, 100.0, 1000.0};
    const CoverageBench bench = cover(settings, {});
    ASSERT_EQ(bench.depths.size(), 3U);
    for (const DepthCoverage& row : bench.depths) {
        EXPECT_GT(row.columns, 3000U) << row.peak_counts;
        EXPECT_GT(row.within_68, 0.63) << row.peak_counts;
        EXPECT_LT(row.within_68, 0.74) << row.peak_counts;
        EXPECT_GT(row.within_95, 0.91) << row.peak_counts;
        EXPECT_GT(row.found, 0.93) << row.peak_counts;
        EXPECT_LT(row.wrong_apart, 0.02) << row.peak_counts;
    }
    // More photons, smaller deviations: they are not one number for all.
    EXPECT_GT(bench.depths[0].median_sigma_m, 2.0 * bench.depths[2].median_sigma_m);
}

}  // namespace
}  // namespace apps
