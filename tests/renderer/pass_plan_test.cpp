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
            const PassPlan plan = renderer::plan_passes(scan_of(9), settings, false);
            EXPECT_GE(samples_of(plan), samples);
            EXPECT_LE(samples_of(plan) - samples, plan.samples_per_pass) << samples;
            EXPECT_LE(static_cast<double>(samples_of(plan)), 1.2 * samples + 2.0) << samples;
        }
    }
}

TEST(PassPlan, PassesAreLongUnlessEachBinNeedsAVariance) {
    renderer::RenderSettings settings;
    settings.samples = 8000;
    EXPECT_EQ(renderer::plan_passes(scan_of(9), settings, false).num_passes, 8);
    settings.variance = true;
    EXPECT_GE(renderer::plan_passes(scan_of(9), settings, false).num_passes, 31);
}

// The caller is asked between passes whether to stop.
TEST(PassPlan, PassesOfLargeScansAreShorter) {
    renderer::RenderSettings settings;
    settings.samples = 1'000'000;
    for (const std::size_t points : {std::size_t{4096}, std::size_t{65'536}}) {
        const PassPlan plan = renderer::plan_passes(scan_of(points), settings, false);
        EXPECT_LE(static_cast<double>(plan.samples_per_pass) * static_cast<double>(points), 4e7);
        EXPECT_GE(plan.samples_per_pass, 256);
    }
}

TEST(PassPlan, LittleWorkGoesOnInShortPasses) {
    renderer::RenderSettings settings;
    settings.target_error = 0.1;
    const int pilot = renderer::plan_passes(scan_of(9), settings, false).samples_per_pass;
    const auto longer = [&](int samples, double fraction) {
        return renderer::plan_longer_passes(scan_of(9), settings, false, samples, fraction);
    };
    EXPECT_FALSE(longer(pilot, 0.5));
    ASSERT_TRUE(longer(pilot, 0.05));
    EXPECT_GE(longer(pilot, 0.05)->samples_per_pass, 4 * pilot);
    // Step by step, up to a length after which the caller may stop.
    int samples = pilot;
    int steps = 0;
    while (const auto next = longer(samples, 1e-300)) {
        EXPECT_LE(next->samples_per_pass, 8 * samples + 4);
        samples = next->samples_per_pass;
        ++steps;
    }
    EXPECT_GE(steps, 2);
    EXPECT_GE(samples, 4096);
}

}  // namespace
