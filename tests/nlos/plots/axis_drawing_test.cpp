// SPDX-License-Identifier: MIT
#include "nlos/plots/axis_drawing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace nlos {
namespace {

TEST(AxisTicks, AreRoundNumbersInsideTheAxis) {
    const AxisTicks ticks = choose_ticks(0.5, -0.5, 8);
    EXPECT_EQ(ticks.labels, (std::vector<std::string>{"−0.4", "−0.2", "0.0", "0.2", "0.4"}));
    EXPECT_EQ(choose_ticks(0.0, 1.0, 3).labels, (std::vector<std::string>{"0.0", "0.5", "1.0"}));
    EXPECT_EQ(choose_ticks(1.49, 3.51, 5).labels,
              (std::vector<std::string>{"1.5", "2.0", "2.5", "3.0", "3.5"}));
    EXPECT_TRUE(choose_ticks(1.0, 1.0, 5).values.empty());
    EXPECT_TRUE(choose_ticks(0.0, NAN, 5).values.empty());
}

TEST(AxisTicks, TakeFarPowersOfTenOutOfTheLabels) {
    const AxisTicks small = choose_ticks(0.0, 3e-6, 4);
    EXPECT_EQ(small.exponent, -6);
    EXPECT_EQ(small.labels, (std::vector<std::string>{"0", "1", "2", "3"}));
    EXPECT_EQ(label_with_exponent("counts", small.exponent), "counts [10⁻⁶]");
    EXPECT_EQ(label_with_exponent("light [W] of all", 12), "light [10¹² W] of all");
    EXPECT_EQ(label_with_exponent("light [W]", 0), "light [W]");
    EXPECT_EQ(choose_ticks(0.0, 4e6, 5).exponent, 6);
    EXPECT_EQ(choose_ticks(0.0, 4e3, 5).exponent, 0);
}

}  // namespace
}  // namespace nlos
