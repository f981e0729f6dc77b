// SPDX-License-Identifier: MIT
#include "renderer/core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <stdexcept>

namespace {

TEST(Parallel, EveryIndexRunsOnce) {
    std::vector<std::atomic<int>> runs(10'007);
    core::parallel_for(runs.size(), [&](std::size_t i) { ++runs[i]; });
    for (const auto& count : runs) EXPECT_EQ(count, 1);
}

TEST(Parallel, BlocksCoverTheRangeWhateverTheThreads) {
    for (const int threads : {1, 7}) {
        const core::ThreadLimit limit(threads);
        std::vector<std::atomic<int>> runs(1'003);
        core::parallel_blocks(runs.size(), 10, [&](std::size_t begin, std::size_t end) {
            EXPECT_EQ(begin % 10, 0U);
            EXPECT_LE(end - begin, 10U);
            for (std::size_t i = begin; i < end; ++i) ++runs[i];
        });
        for (const auto& count : runs) EXPECT_EQ(count, 1);
    }
}

TEST(Parallel, SumHasTheSameBitsForAnyNumberOfThreads) {
    const std::function<double(std::size_t)> term = [](std::size_t i) {
        return std::sin(static_cast<double>(i)) * 1e3;
    };
    double one = 0.0;
    {
        const core::ThreadLimit limit(1);
        one = core::parallel_sum(100'000, 0.0, term);
    }
    const core::ThreadLimit limit(7);
    EXPECT_EQ(core::parallel_sum(100'000, 0.0, term), one);
}

TEST(Parallel, ExceptionsReachTheCaller) {
    EXPECT_THROW(core::parallel_for(100,
                                    [](std::size_t i) {
                                        if (i == 50) throw std::runtime_error("here");
                                    }),
                 std::runtime_error);
}

}  // namespace
