// SPDX-License-Identifier: MIT
#include "apps/bench/field/bin_agreement.h"

#include "renderer/core/random.h"

#include <gtest/gtest.h>

#include <cmath>

namespace apps {
namespace {

constexpr std::size_t kSide = 8;
constexpr int kBins = 64;
constexpr std::size_t kBlock = 4;
constexpr double kLeastFraction = 0.05;
constexpr int kRuns = 24;

// A hump of light in every histogram, in other bins for other points.
core::Transient hump() {
    core::Transient truth(kSide * kSide, kBins);
    for (std::size_t p = 0; p < truth.num_pairs(); ++p) {
        for (int b = 0; b < kBins; ++b) {
            const double offset = (b - 20.0 - 0.3 * static_cast<double>(p)) / 6.0;
            truth.values()[p * kBins + static_cast<std::size_t>(b)] =
                static_cast<float>(std::exp(-offset * offset));
        }
    }
    return truth;
}

// Runs of a renderer whose paths each add the same light: Poisson counts of many paths.
std::vector<core::Transient> runs_of(const core::Transient& truth, double paths_per_unit) {
    std::vector<core::Transient> runs;
    core::Rng random(7, 0, 0);
    for (int r = 0; r < kRuns; ++r) {
        core::Transient& run = runs.emplace_back(truth);
        for (float& value : run.values()) {
            // A sum of two uniform numbers with the mean and variance of the counts is near enough.
            const double mean = double{value} * paths_per_unit;
            const double spread = std::sqrt(6.0 * mean);
            value = static_cast<float>(
                (mean + spread * (random.uniform() + random.uniform() - 1.0)) / paths_per_unit);
        }
    }
    return runs;
}

BinAgreement compare(const core::Transient& truth, const std::vector<core::Transient>& runs) {
    return bin_agreement_of(truth, runs, {kSide, kSide}, kBlock, kLeastFraction);
}

TEST(BinAgreement, RunsThatVaryByChanceAgree) {
    const core::Transient truth = hump();
    const BinAgreement found = compare(truth, runs_of(truth, 30.0));
    // One in 10,000 by chance; the random numbers are fixed, so that the test never changes.
    const double most = largest_score_by_chance(found.num_cells + 1, 1e-4);
    EXPECT_GT(found.num_cells, 40);
    EXPECT_LT(std::abs(found.worst_z), most);
    EXPECT_LT(std::abs(found.energy_z), most);
    EXPECT_NEAR(found.energy_ratio, 1.0, 0.01);
    // The mean square of n scores deviates from 1 by sqrt(2 / n).
    EXPECT_NEAR(found.rms_z * found.rms_z, 1.0, 4.0 * std::sqrt(2.0 / found.num_cells));
}

TEST(BinAgreement, AFactorShowsInTheEnergy) {
    const core::Transient truth = hump();
    std::vector<core::Transient> runs = runs_of(truth, 30.0);
    for (core::Transient& run : runs) {
        for (float& value : run.values()) value *= 1.02F;
    }
    const BinAgreement found = compare(truth, runs);
    EXPECT_NEAR(found.energy_ratio, 1.02, 0.005);
    EXPECT_GT(found.energy_z, 5.0);
}

TEST(BinAgreement, AShiftOfOneBinShowsInTheCells) {
    const core::Transient truth = hump();
    std::vector<core::Transient> runs = runs_of(truth, 30.0);
    for (core::Transient& run : runs) {
        const auto values = run.values();
        for (std::size_t i = values.size() - 1; i > 0; --i) values[i] = values[i - 1];
    }
    const BinAgreement found = compare(truth, runs);
    EXPECT_GT(std::abs(found.worst_z), 6.0);
    EXPECT_LT(std::abs(found.energy_z), 4.0);
}

TEST(BinAgreement, LightWhereThereIsNoneIsNeverChance) {
    const core::Transient truth(kSide * kSide, kBins);
    core::Transient lit = truth;
    lit.values()[5] = 1.0F;
    const BinAgreement found = compare(truth, std::vector<core::Transient>(kRuns, lit));
    EXPECT_TRUE(std::isinf(found.worst_z));
}

TEST(BinAgreement, TheLargestScoreByChance) {
    EXPECT_NEAR(largest_score_by_chance(1, 0.05), 1.95996, 1e-4);
    // One minus 0.99 to the power 1/1000: twice the normal tail beyond 4.4148.
    const double most = largest_score_by_chance(1000, 0.01);
    EXPECT_NEAR(std::pow(1.0 - std::erfc(most / std::sqrt(2.0)), 1000), 0.99, 1e-9);
}

}  // namespace
}  // namespace apps
