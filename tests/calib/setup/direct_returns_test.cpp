// SPDX-License-Identifier: MIT
// Peaks of simulated direct returns: found far below a bin, with honest errors.
#include "calib/setup/direct_returns.h"

#include "tests/calib/setup/simulated_setup.h"
#include "tests/support/error_message.h"
#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using setup_test::direct_returns;
using setup_test::kBin_m;
using setup_test::kSigma_m;

TEST(DirectReturns, PeaksAreFoundFarBelowABinWithHonestErrors) {
    std::vector<double> opl;
    for (int i = 0; i < 60; ++i) opl.push_back(2.0 + 0.01337 * i);
    const auto capture = direct_returns(opl, 1000.0, 0.0, "PeaksAreFound");
    const auto result = calib::fit_direct_returns(capture, calib::ResponseShape::Gaussian);
    double squared = 0.0;
    for (std::size_t i = 0; i < opl.size(); ++i) {
        EXPECT_LT(result.points[i].sigma_m, 0.06 * kBin_m);
        squared += std::pow((result.points[i].opl_m - opl[i]) / result.points[i].sigma_m, 2.0);
    }
    EXPECT_GT(test_support::chi_square_tail(squared, 60.0), 1e-4);
    EXPECT_LT(test_support::chi_square_tail(squared, 60.0), 1.0 - 1e-4);
    EXPECT_NEAR(result.sigma_m, kSigma_m, 4.0 * result.sigma_error_m);
    EXPECT_NEAR(result.ambient, 0.05, 4.0 * result.ambient_error + 1e-3);
}

TEST(DirectReturns, TailIsSeparatedFromTheCore) {
    const std::vector<double> opl(40, 2.2345);
    const auto capture = direct_returns(opl, 3000.0, 0.03, "TailIsSeparated");
    const auto result =
        calib::fit_direct_returns(capture, calib::ResponseShape::GaussianExponential);
    EXPECT_NEAR(result.tail_m, 0.03, 5.0 * result.tail_error_m);
    EXPECT_LT(result.tail_error_m, 1e-3);
    EXPECT_NEAR(result.points[7].opl_m, 2.2345, 5.0 * result.points[7].sigma_m);
    EXPECT_NEAR(result.deviance, result.expected_deviance, 0.15 * result.expected_deviance);
}

TEST(DirectReturns, ATailThatIsNotThereCostsNothing) {
    const std::vector<double> opl(30, 2.0);
    const core::Capture capture = direct_returns(opl, 1000.0, 0.0, "no tail");
    const auto gaussian = calib::fit_direct_returns(capture, calib::ResponseShape::Gaussian);
    const auto tailed =
        calib::fit_direct_returns(capture, calib::ResponseShape::GaussianExponential);
    for (std::size_t p = 0; p < opl.size(); ++p) {
        EXPECT_LT(tailed.points[p].sigma_m, 6.0 * gaussian.points[p].sigma_m) << p;
        EXPECT_NEAR(tailed.points[p].opl_m, opl[p], 5.0 * tailed.points[p].sigma_m) << p;
    }
}

TEST(DirectReturns, AnEmptyHistogramIsNamed) {
    auto capture = direct_returns({2.0, 2.1}, 100.0, 0.0, "Empty");
    for (float& value : capture.transient.histogram(1)) value = 0.0F;
    EXPECT_ERROR_WITH(calib::fit_direct_returns(capture, calib::ResponseShape::Gaussian),
                      "point 1");
}

}  // namespace
