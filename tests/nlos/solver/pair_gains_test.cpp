// SPDX-License-Identifier: MIT
#include "nlos/solver/pair_gains.h"

#include <gtest/gtest.h>

namespace nlos {
namespace {

// The prior of 1 +- 0.3 weighs as much as 1 / 0.09 of expected light.
TEST(PairGains, AreRatiosOfLightHeldTowardsOne) {
    PairGains gains(3);
    gains.update({50.0, 200.0, 0.0}, {100.0, 100.0, 0.0});
    const double weight = 1.0 / 0.09;
    const double low = (50.0 + weight) / (100.0 + weight);
    const double high = (200.0 + weight) / (100.0 + weight);
    const double mean = (low + high + 1.0) / 3.0;
    EXPECT_NEAR(gains[0], low / mean, 1e-6);
    EXPECT_NEAR(gains[1], high / mean, 1e-6);
    EXPECT_NEAR(gains[2], 1.0 / mean, 1e-6);
}

TEST(PairGains, OfDeadPointsStayPositive) {
    PairGains gains(2);
    gains.update({-1e6, 1e6}, {1e6, 1e6});
    EXPECT_GT(gains[0], 0.0F);
    EXPECT_LT(gains[0], 0.05F);
}

}  // namespace
}  // namespace nlos
