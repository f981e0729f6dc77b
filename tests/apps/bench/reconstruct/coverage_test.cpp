// SPDX-License-Identifier: MIT
// What `nlos bench coverage` measures, on fewer surfaces.
#include "apps/bench/reconstruct/reconstruct.h"
#include "renderer/core/settings/json_file.h"

#include <gtest/gtest.h>

namespace apps {
namespace {

TEST(Coverage, OfReportedDepthsIsThatOfTheirDeviations) {
    CoverageBenchSettings settings;
    settings.surfaces = 20;
    settings.first = 500;
    settings.methods = {"lct"};
    settings.peaks = {20.0, 100.0, 1000.0};
    const core::Json depths = measure_coverage(settings, {}).figures["depths"];
    ASSERT_EQ(depths.size(), 3U);
    for (const core::Json& row : depths) {
        EXPECT_GT(row["columns"].get<double>(), 3000.0) << row;
        EXPECT_GT(row["within_68"].get<double>(), 0.63) << row;
        EXPECT_LT(row["within_68"].get<double>(), 0.74) << row;
        EXPECT_GT(row["within_95"].get<double>(), 0.91) << row;
        EXPECT_GT(row["found"].get<double>(), 0.93) << row;
        EXPECT_LT(row["wrong_apart"].get<double>(), 0.02) << row;
    }
    // More photons, smaller deviations: they are not one number for all.
    EXPECT_GT(depths[0]["median_sigma_m"].get<double>(),
              2.0 * depths[2]["median_sigma_m"].get<double>());
}

}  // namespace
}  // namespace apps
