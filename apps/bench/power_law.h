// SPDX-License-Identifier: MIT
#pragma once

#include <span>

namespace apps {

/// y = coefficient * x^exponent.
struct PowerLaw {
    double coefficient = 0.0;
    double exponent = 0.0;
};

/// The law whose line lies closest to the points by least squares, in logarithms of both. All
/// values are above 0; with fewer than two different x the exponent is 0.
PowerLaw fit_power_law(std::span<const double> x, std::span<const double> y);

}  // namespace apps
