// SPDX-License-Identifier: MIT
#include "apps/bench/statistics.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace {

TEST(PowerLaw, ExactLawsComeBack) {
    const std::array x{0.5, 2.0, 3.0, 100.0};
    std::array<double, 4> y;
    for (std::size_t i = 0; i < x.size(); ++i) y[i] = 0.7 * std::pow(x[i], -1.5);
    const apps::PowerLaw law = apps::fit_power_law(x, y);
    EXPECT_NEAR(law.exponent, -1.5, 1e-13);
    EXPECT_NEAR(law.coefficient, 0.7, 1e-13);
}

TEST(PowerLaw, OnePointHasNoExponent) {
    const std::array x{2.0};
    const std::array y{3.0};
    EXPECT_EQ(apps::fit_power_law(x, y).exponent, 0.0);
    EXPECT_EQ(apps::fit_power_law({}, {}).exponent, 0.0);
}

}  // namespace
