// SPDX-License-Identifier: MIT
#include "tests/support/repeated_estimates.h"

#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <cmath>

namespace test_support {
namespace {

constexpr int kRenders = 24;

// A t value as the normal value of about the same tail (source [Wallace1959]).
double normal_of_t(double t) {
    constexpr double kDegrees = kRenders - 1;
    return std::copysign(
        std::sqrt(kDegrees * std::log1p(t * t / kDegrees)) * (1.0 - 3.0 / (16.0 * kDegrees)), t);
}

}  // namespace

Numbers sums_of(const core::Transient& transient) {
    Numbers numbers(transient.num_bins() + transient.num_pairs() + 1);
    for (std::size_t pair = 0; pair < transient.num_pairs(); ++pair) {
        const auto histogram = transient.histogram(pair);
        for (std::size_t bin = 0; bin < histogram.size(); ++bin) {
            const double value = double{histogram[bin]};
            numbers[bin] += value;
            numbers[histogram.size() + pair] += value;
            numbers.back() += value;
        }
    }
    return numbers;
}

Estimate repeat(const std::function<Numbers(std::uint64_t seed)>& render, const std::string& name) {
    Estimate estimate;
    Numbers squares;
    for (int i = 0; i < kRenders; ++i) {
        const Numbers numbers = render(seed_of(name) + static_cast<std::uint64_t>(i));
        estimate.mean.resize(numbers.size());
        squares.resize(numbers.size());
        for (std::size_t k = 0; k < numbers.size(); ++k) {
            estimate.mean[k] += numbers[k] / kRenders;
            squares[k] += numbers[k] * numbers[k] / kRenders;
        }
    }
    for (std::size_t k = 0; k < squares.size(); ++k) {
        const double spread = std::max(0.0, squares[k] - estimate.mean[k] * estimate.mean[k]);
        estimate.squared_error.push_back(spread / (kRenders - 1));
    }
    return estimate;
}

void expect_same_means(const Estimate& a, const Estimate& b, double max_relative_error) {
    ASSERT_EQ(a.mean.size(), b.mean.size());
    std::vector<std::pair<double, std::size_t>> compared;
    for (std::size_t k = 0; k < a.mean.size(); ++k) {
        // Numbers that few paths make are far from normal.
        const double error_a = std::sqrt(a.squared_error[k]);
        const double error_b = std::sqrt(b.squared_error[k]);
        const bool is_large = b.mean[k] > 0.02 * b.mean.back() && error_b < 0.1 * b.mean[k];
        if (!is_large && !(error_a < 0.1 * a.mean[k] && error_b < 0.1 * b.mean[k])) continue;
        compared.emplace_back((a.mean[k] - b.mean[k]) / std::hypot(error_a, error_b), k);
    }
    ASSERT_GT(4 * compared.size(), a.mean.size());
    const double level = sidak_level(1e-3, compared.size());
    for (const auto& [t, k] : compared) {
        EXPECT_GT(normal_tail(normal_of_t(t)), level)
            << "number " << k << " of " << a.mean.size() << ": " << a.mean[k] << " against "
            << b.mean[k];
    }
    // The total, tightly.
    const double sigma = std::sqrt(a.squared_error.back() + b.squared_error.back());
    EXPECT_LT(sigma, max_relative_error * b.mean.back());
}

}  // namespace test_support
