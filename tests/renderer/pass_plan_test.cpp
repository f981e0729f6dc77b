// SPDX-License-Identifier: MIT
#include "renderer/pass_plan.h"

#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace {

using core::Vec3;
using renderer::PassPlan;

core::Scan scan_of(std::size_t points) {
    return test_support::confocal_scan(std::vector<Vec3>(points, Vec3::Zero()));
}

std::int64_t samples_of(const PassPlan& plan) {
    return std::int64_t{plan.samples_per_pass} * plan.num_passes;
}

TEST(PassPlan, TakesTheSamplesAskedForOrAFewMore) {
    renderer::RenderSettings settings;
    for (const bool variance : {false, true}) {
        settings.variance = variance;
        for (const int samples : {1, 2, 7, 33, 100, 512, 2049, 10'000, 1'000'003, 2'147'483'647}) {
            settings.samples = samples;
            const PassPlan plan = renderer::plan_passes(scan_of(9), settings);
            EXPECT_GE(samples_of(plan), samples);
            EXPECT_LE(samples_of(plan) - samples, plan.samples_per_pass) << samples;
            EXPECT_LE(static_cast<double>(samples_of(plan)), 1.2 * samples + 2.0) << samples;
        }
    }
}

TEST(PassPlan, PassesAreLongUnlessEachBinNeedsAVariance) {
    renderer::RenderSettings settings;
    settings.samples = 8000;
    EXPECT_EQ(renderer::plan_passes(scan_of(9), settings).num_passes, 8);
    settings.variance = true;
    EXPECT_GE(renderer::plan_passes(scan_of(9), settings).num_passes, 31);
}

// The caller is asked between passes whether to stop.
TEST(PassPlan, PassesOfLargeScansAreShorter) {
    renderer::RenderSettings settings;
    settings.samples = 1'000'000;
    for (const std::size_t points : {std::size_t{4096}, std::size_t{65'536}}) {
        const PassPlan plan = renderer::plan_passes(scan_of(points), settings);
        EXPECT_LE(static_cast<double>(plan.samples_per_pass) * static_cast<double>(points), 4e7);
        EXPECT_GE(plan.samples_per_pass, 256);
    }
}

TEST(PassPlan, LittleWorkGoesOnInShortPasses) {
    renderer::RenderSettings settings;
    settings.target_error = 0.1;
    const int pilot = renderer::plan_passes(scan_of(9), settings).samples_per_pass;
    EXPECT_FALSE(renderer::plan_after_pilot(scan_of(9), settings, 0.5));
    const auto longer = renderer::plan_after_pilot(scan_of(9), settings, 0.01);
    ASSERT_TRUE(longer);
    EXPECT_GE(longer->samples_per_pass, 2 * pilot);
    const auto longest = renderer::plan_after_pilot(scan_of(9), settings, 1e-300);
    ASSERT_TRUE(longest);
    EXPECT_GT(longest->samples_per_pass, longer->samples_per_pass);
}

}  // namespace
