// SPDX-License-Identifier: MIT
#include "renderer/core/random.h"

#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace {

TEST(Rng, SameIndicesGiveTheSameStream) {
    core::Rng a(1, 2, 3);
    core::Rng b(1, 2, 3);
    for (int i = 0; i < 100; ++i) EXPECT_EQ(a.next_bits(), b.next_bits());
}

TEST(Rng, NeighbouringIndicesGiveDifferentStreams) {
    std::set<std::uint64_t> first;
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
        for (std::uint64_t item = 0; item < 32; ++item) {
            for (std::uint64_t sample = 0; sample < 32; ++sample) {
                first.insert(core::Rng(seed, item, sample).next_bits());
            }
        }
    }
    EXPECT_EQ(first.size(), 8U * 32U * 32U);
}

// Pairs of numbers within a stream, and first numbers across streams, fill the unit square evenly.
TEST(Rng, PairsWithinAndAcrossStreamsAreUniform) {
    constexpr std::size_t kCells = 16;
    constexpr int kDraws = 1 << 16;
    for (const bool across : {false, true}) {
        std::vector<double> observed(kCells * kCells, 0.0);
        core::Rng rng(test_support::seed_of("Rng.Pairs"), 0, 0);
        for (int i = 0; i < kDraws; ++i) {
            core::Rng other(test_support::seed_of("Rng.Pairs"), 0, static_cast<std::uint64_t>(i));
            core::Rng next(
                test_support::seed_of("Rng.Pairs"), 0, static_cast<std::uint64_t>(i) + 1);
            const double x = across ? other.uniform() : rng.uniform();
            const double y = across ? next.uniform() : rng.uniform();
            observed[static_cast<std::size_t>(x * kCells) * kCells +
                     static_cast<std::size_t>(y * kCells)] += 1.0;
        }
        const std::vector<double> expected(observed.size(),
                                           kDraws / static_cast<double>(observed.size()));
        EXPECT_GT(test_support::chi_square_p_value(observed, expected), 1e-4) << across;
    }
}

}  // namespace
