// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cmath>

namespace nlos {

/// argmin over m >= 0 of m - y log m + penalty (m - e)^2 / 2: what a Poisson count of y makes of an
/// expectation e.
///
/// y         not negative
/// penalty   positive
inline float poisson_proximal(float y, float e, float penalty) {
    const float slope = 1.0F - penalty * e;  // m solves penalty m^2 + slope m = y
    const float root = std::sqrt(slope * slope + 4.0F * penalty * y);
    // Of the two forms of the solution the one that does not cancel.
    return slope > 0.0F ? 2.0F * y / (slope + root) : (root - slope) / (2.0F * penalty);
}

/// Twice how much less likely a Poisson count of y is under an expectation m than under y itself.
inline double poisson_deviance(double y, double m) {
    const double expected = std::max(m, 1e-3 * std::max(y, 1e-3));
    return 2.0 * (y > 0.0 ? y * std::log(y / expected) - (y - expected) : expected);
}

/// argmin over m of weight (m - y)^2 / 2 + penalty (m - e)^2 / 2.
inline float gaussian_proximal(float y, float e, float weight, float penalty) {
    return (weight * y + penalty * e) / (weight + penalty);
}

}  // namespace nlos
