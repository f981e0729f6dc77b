// SPDX-License-Identifier: MIT
#pragma once

namespace calib {

/// A residual and its derivative by the expected count.
struct Residual {
    double value = 0.0;
    double gradient = 0.0;
};

/// Signed square root of the Poisson deviance 2 [mu - n + n ln(n / mu)].
///
/// expected   mu > 0
/// counted    n >= 0, not necessarily whole
/// source     [McCullagh1989]; series for n near mu derived in the .cpp
Residual signed_deviance(double expected, double counted);

/// Mean and variance of the deviance of one Poisson count of this expectation.
struct DevianceMoments {
    double mean = 0.0;
    double variance = 0.0;
};
DevianceMoments deviance_moments(double expected);

}  // namespace calib
