// SPDX-License-Identifier: MIT
#include "renderer/core/system/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <stdexcept>
#include <thread>

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

TEST(Parallel, ResultsAreUsedInOrderAndFewExistAtATime) {
    for (const int threads : {1, 7}) {
        const core::ThreadLimit limit(threads);
        std::atomic<int> alive{0};
        std::atomic<int> most{0};
        std::vector<std::size_t> used;
        const bool all = core::parallel_in_order<std::size_t>(
            500,
            [&](std::size_t i) {
                const int now = ++alive;
                for (int seen = most; seen < now && !most.compare_exchange_weak(seen, now);) {
                }
                return i * i;
            },
            [&](std::size_t i, std::size_t square) {
                --alive;
                EXPECT_EQ(square, i * i);
                used.push_back(i);
                return true;
            });
        EXPECT_TRUE(all);
        ASSERT_EQ(used.size(), 500U);
        for (std::size_t i = 0; i < used.size(); ++i) EXPECT_EQ(used[i], i);
        EXPECT_LE(most, 2 * threads);
    }
}

TEST(Parallel, WorkInOrderEndsEarlyWhenTheUserOfResultsSaysSo) {
    const core::ThreadLimit limit(7);
    int used = 0;
    EXPECT_FALSE(core::parallel_in_order<int>(
        1000, [](std::size_t) { return 1; }, [&](std::size_t, int) { return ++used < 10; }));
    EXPECT_EQ(used, 10);
    EXPECT_FALSE(core::parallel_in_order<int>(
        10, [](std::size_t) { return 1; }, [&](std::size_t i, int) { return i < 9; }))
        << "at the last";
    EXPECT_THROW(core::parallel_in_order<int>(
                     100,
                     [](std::size_t i) -> int {
                         if (i == 20) throw std::runtime_error("made");
                         return 1;
                     },
                     [](std::size_t, int) { return true; }),
                 std::runtime_error);
}

TEST(Parallel, LoopsInsideWorkOnOneThreadStayOnIt) {
    const core::ThreadLimit limit(7);
    core::parallel_for(20, [](std::size_t) {
        core::run_on_one_thread([] {
            const auto self = std::this_thread::get_id();
            core::parallel_for(100,
                               [&](std::size_t) { EXPECT_EQ(std::this_thread::get_id(), self); });
        });
    });
}

}  // namespace
