// SPDX-License-Identifier: MIT
#include "renderer/core/capture/time_axis.h"

#include <gtest/gtest.h>

#include <limits>

namespace {

TEST(TimeAxis, BinsAreHalfOpen) {
    const core::TimeAxis axis{1.0, 0.5, 4};
    EXPECT_EQ(axis.bin_of(1.0), 0);
    EXPECT_EQ(axis.bin_of(1.5), 1);
    EXPECT_EQ(axis.bin_of(2.9999), 3);
    EXPECT_FALSE(axis.bin_of(3.0));
    EXPECT_FALSE(axis.bin_of(0.9999));
    EXPECT_FALSE(axis.bin_of(std::numeric_limits<double>::quiet_NaN()));
}

TEST(TimeAxis, BinCenterLiesInItsBin) {
    const core::TimeAxis axis{-0.3, 0.008, 512};
    for (int i = 0; i < axis.num_bins; ++i) EXPECT_EQ(axis.bin_of(axis.bin_center_m(i)), i);
}

TEST(TimeAxis, ValidateNamesKeyValueAndLimit) {
    try {
        core::validate(core::TimeAxis{0.0, 0.008, 0}, "time_axis");
        FAIL();
    } catch (const core::Error& error) {
        EXPECT_STREQ(error.what(), "time_axis.num_bins: found 0; must be at least 1");
    }
    EXPECT_THROW(core::validate(core::TimeAxis{0.0, 0.0, 5}, "t"), core::Error);
    EXPECT_THROW(core::validate(core::TimeAxis{0.0, -1.0, 5}, "t"), core::Error);
}

}  // namespace
