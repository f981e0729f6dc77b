// SPDX-License-Identifier: MIT
#include "renderer/core/system/large_memory.h"

#include "renderer/core/system/parallel.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace core {
namespace {

TEST(LargeMemory, ZerosAreZeroWhateverStoodThere) {
    for (const int threads : {1, 3}) {
        const ThreadLimit limit(threads);
        // None, less than a huge page, and several with something before and behind.
        for (const std::size_t count : {0U, 1000U, 5'000'001U}) {
            std::vector<float>(count, 7.0F);  // its memory may come back
            const std::vector<float> values = zeros(count);
            EXPECT_EQ(values.size(), count);
            EXPECT_TRUE(std::ranges::all_of(values, [](float value) { return value == 0.0F; }));
        }
    }
}

}  // namespace
}  // namespace core
