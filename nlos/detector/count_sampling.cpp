// SPDX-License-Identifier: MIT
#include "nlos/detector/count_sampling.h"

#include "renderer/core/types.h"

#include <array>
#include <cassert>
#include <cmath>

namespace nlos {
namespace {

constexpr double kMinForRejection = 10.0;  // below, inversion is as fast, and it is simpler

/// ln k!, by Stirling's series behind a table.
double log_factorial(double k) {
    constexpr std::array<double, 10> kFactorials{
        1.0, 1.0, 2.0, 6.0, 24.0, 120.0, 720.0, 5040.0, 40320.0, 362880.0};
    if (k < static_cast<double>(kFactorials.size())) {
        return std::log(kFactorials[static_cast<std::size_t>(k)]);
    }
    const double n = k + 1.0;
    const double y = 1.0 / (n * n);
    const double series = (1.0 / 12.0 - y * (1.0 / 360.0 - y * (1.0 / 1260.0 - y / 1680.0))) / n;
    return (n - 0.5) * std::log(n) - n + 0.5 * std::log(2.0 * core::kPi) + series;
}

/// Adds up probabilities until they exceed a uniform number.
///
/// first      probability of 0
/// ratio(k)   probability of k over that of k - 1
template <class Ratio>
double invert(core::Rng& rng, double first, double most, Ratio&& ratio) {
    double left = rng.uniform();
    double probability = first;
    double k = 0.0;
    while (left >= probability && k < most) {
        left -= probability;
        k += 1.0;
        probability *= ratio(k);
        if (probability == 0.0) break;  // the uniform number is above all that a double can sum
    }
    return k;
}

/// Constants of a hat over a bell-shaped distribution: k = floor((2 a / us + b) u + center), with
/// u uniform in [-1/2, 1/2] and us = 1/2 - |u|.
struct Hat {
    double a;
    double b;
    double center;
    double height;         ///< of the hat over the distribution's maximum, or its inverse mass
    double quick_squeeze;  ///< below it, v accepts at once where us is not small
};

/// Transformed rejection: `log_ratio(k)` is the distribution's logarithm on the hat's scale.
template <class LogRatio>
double reject(core::Rng& rng, const Hat& hat, double most, LogRatio&& log_ratio) {
    while (true) {
        const double u = rng.uniform() - 0.5;
        const double v = 1.0 - rng.uniform();  // in (0, 1]
        const double us = 0.5 - std::abs(u);
        const double k = std::floor((2.0 * hat.a / us + hat.b) * u + hat.center);
        if (us >= 0.07 && v <= hat.quick_squeeze) return k;
        if (!(k >= 0.0) || k > most) continue;
        if (std::log(v * hat.height / (hat.a / (us * us) + hat.b)) <= log_ratio(k)) return k;
    }
}

}  // namespace

std::int64_t sample_poisson(core::Rng& rng, double mean) {
    assert(mean >= 0.0 && std::isfinite(mean));
    constexpr double kMax = 9e18;
    if (mean < kMinForRejection) {
        return static_cast<std::int64_t>(
            invert(rng, std::exp(-mean), kMax, [&](double k) { return mean / k; }));
    }
    const double b = 0.931 + 2.53 * std::sqrt(mean);
    const double a = -0.059 + 0.02483 * b;
    const Hat hat{a, b, mean + 0.43, 1.1239 + 1.1328 / (b - 3.4), 0.9277 - 3.6224 / (b - 2.0)};
    const double log_mean = std::log(mean);
    return static_cast<std::int64_t>(
        reject(rng, hat, kMax, [&](double k) { return k * log_mean - mean - log_factorial(k); }));
}

std::int64_t sample_binomial(core::Rng& rng, std::int64_t trials, double probability) {
    assert(trials >= 0 && probability >= 0.0 && probability <= 1.0);
    if (probability > 0.5) return trials - sample_binomial(rng, trials, 1.0 - probability);
    if (trials == 0 || probability == 0.0) return 0;
    const auto n = static_cast<double>(trials);
    const double p = probability;
    const double odds = p / (1.0 - p);
    if (n * p < kMinForRejection) {
        return static_cast<std::int64_t>(
            invert(rng, std::exp(n * std::log1p(-p)), n, [&](double k) {
                return odds * (n - k + 1.0) / k;
            }));
    }
    const double deviation = std::sqrt(n * p * (1.0 - p));
    const double b = 1.15 + 2.53 * deviation;
    const double a = -0.0873 + 0.0248 * b + 0.01 * p;
    const Hat hat{a, b, n * p + 0.5, (2.83 + 5.1 / b) * deviation, 0.92 - 4.2 / b};
    const double mode = std::floor((n + 1.0) * p);
    const double log_odds = std::log(odds);
    const double at_mode = log_factorial(mode) + log_factorial(n - mode);
    return static_cast<std::int64_t>(reject(rng, hat, n, [&](double k) {
        return at_mode - log_factorial(k) - log_factorial(n - k) + (k - mode) * log_odds;
    }));
}

}  // namespace nlos
