// SPDX-License-Identifier: MIT
#include "calib/statistics/poisson_deviance.h"

#include <algorithm>
#include <cmath>

namespace calib {
namespace {

// With t = (n - mu)/mu the deviance is 2 mu [(1+t) ln(1+t) - t] = mu t^2 (1 - t/3 + t^2/6 - ...),
// whose root is -r = t sqrt(mu) (1 - t/6 + 5 t^2/72 - ...).
constexpr double kSmall = 1e-3;

double deviance(double mu, double n) {
    return 2.0 * (mu - n + (n > 0.0 ? n * std::log(n / mu) : 0.0));
}

}  // namespace

Residual signed_deviance(double expected, double counted) {
    const double t = (counted - expected) / expected;
    if (std::abs(t) < kSmall) {
        const double root = std::sqrt(expected);
        const double series = 1.0 - t / 6.0 + 5.0 * t * t / 72.0;
        return {-t * root * series, 1.0 / (root * series)};
    }
    const double size = std::sqrt(std::max(0.0, deviance(expected, counted)));
    const double value = expected > counted ? size : -size;
    return {value, (1.0 - counted / expected) / value};
}

DevianceMoments deviance_moments(double expected) {
    if (expected <= 0.0) return {};
    if (expected > 50.0) {  // Lawley's expansion
        const double inverse = 1.0 / expected;
        return {1.0 + inverse * (1.0 + inverse * (1.0 + 1.9 * inverse)) / 6.0,
                2.0 + inverse * (2.0 + 4.0 * inverse) / 3.0};
    }
    double mean = 0.0;
    double square = 0.0;
    double probability = std::exp(-expected);
    const int last = static_cast<int>(expected + 12.0 * std::sqrt(expected) + 20.0);
    for (int n = 0; n <= last; ++n) {
        const double d = deviance(expected, n);
        mean += probability * d;
        square += probability * d * d;
        probability *= expected / (n + 1.0);
    }
    return {mean, square - mean * mean};
}

}  // namespace calib
