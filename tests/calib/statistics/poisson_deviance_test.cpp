// SPDX-License-Identifier: MIT
#include "calib/statistics/poisson_deviance.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using calib::signed_deviance;

TEST(PoissonDeviance, SquaredItIsTheDeviance) {
    for (const double mu : {0.01, 0.3, 2.0, 500.0}) {
        for (const double n : {0.0, 1.0, 3.0, 480.0}) {
            const double deviance = 2.0 * (mu - n + (n > 0.0 ? n * std::log(n / mu) : 0.0));
            const double r = signed_deviance(mu, n).value;
            EXPECT_NEAR(r * r, deviance, 1e-9 * (1.0 + deviance));
            EXPECT_EQ(r > 0.0, mu > n);
        }
    }
}

TEST(PoissonDeviance, IsSmoothWhereTheSeriesTakesOver) {
    constexpr double kMean = 40.0;
    for (const double t : {-1e-3, 1e-3}) {
        const auto inside = signed_deviance(kMean, kMean * (1.0 + t * (1.0 - 1e-9)));
        const auto outside = signed_deviance(kMean, kMean * (1.0 + t * (1.0 + 1e-9)));
        EXPECT_NEAR(inside.value, outside.value, 1e-9);
        EXPECT_NEAR(inside.gradient, outside.gradient, 1e-7);
    }
}

TEST(PoissonDeviance, GradientMatchesFiniteDifferences) {
    for (const double mu : {0.02, 1.0, 39.99, 40.0, 700.0}) {
        for (const double n : {0.0, 1.0, 40.0}) {
            const double h = 1e-5 * mu;
            const double gradient =
                (signed_deviance(mu + h, n).value - signed_deviance(mu - h, n).value) / (2.0 * h);
            EXPECT_NEAR(
                signed_deviance(mu, n).gradient, gradient, 1e-5 * (1.0 + std::abs(gradient)));
        }
    }
}

TEST(PoissonDeviance, ExpectationIsFarBelowOneAtLowCounts) {
    EXPECT_NEAR(calib::deviance_moments(0.01).mean, 0.09, 0.01);
    EXPECT_NEAR(calib::deviance_moments(0.1).mean, 0.47, 0.01);
    EXPECT_NEAR(calib::deviance_moments(1.0).mean, 1.15, 0.01);
    EXPECT_NEAR(calib::deviance_moments(49.9).mean, calib::deviance_moments(50.1).mean, 1e-3);
    EXPECT_NEAR(
        calib::deviance_moments(49.9).variance, calib::deviance_moments(50.1).variance, 5e-3);
}

}  // namespace
