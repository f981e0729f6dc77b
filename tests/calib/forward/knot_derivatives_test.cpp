// SPDX-License-Identifier: MIT
#include "calib/forward/knot_derivatives.h"

#include "tests/support/random_geometry.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

namespace {

using calib::KnotDerivative;
using calib::KnotFit;

TEST(KnotFit, PullIsTheTransposeOfChange) {
    core::Rng rng(test_support::seed_of("KnotFit"), 0, 0);
    int num_clamped = 0;
    for (int i = 0; i < 200; ++i) {
        const auto draw = [&](double low, double high) {
            std::array<double, 6> values{};
            for (double& value : values) value = low + (high - low) * rng.uniform();
            return values;
        };
        // Where midpoints weigh little against the corners, the spread of these is clamped.
        std::array<double, 6> weight = draw(0.0, 1.0);
        if (i % 2 == 1) {
            for (std::size_t j = 3; j < 6; ++j) weight[j] *= 0.2;
        }
        const KnotFit fit(draw(1.0, 2.0), weight);
        num_clamped +=
            *std::min_element(fit.knots().weight.begin(), fit.knots().weight.end()) < 1e-12;
        const auto opl_change = draw(-1.0, 1.0);
        const auto weight_change = draw(-1.0, 1.0);
        const auto by = draw(-1.0, 1.0);
        const KnotDerivative by_knots{{by[0], by[1], by[2]}, {by[3], by[4], by[5]}};
        const KnotDerivative change = fit.change(opl_change, weight_change);
        const auto gradients = fit.pull(by_knots);
        double forward = 0.0;
        double reverse = 0.0;
        for (std::size_t j = 0; j < 3; ++j) {
            forward += by_knots.opl[j] * change.opl[j] + by_knots.weight[j] * change.weight[j];
        }
        for (std::size_t j = 0; j < 6; ++j) {
            reverse += gradients.opl[j] * opl_change[j] + gradients.weight[j] * weight_change[j];
        }
        EXPECT_NEAR(forward, reverse, 1e-12);
    }
    EXPECT_GT(num_clamped, 20);
    EXPECT_LT(num_clamped, 180);
}

}  // namespace
