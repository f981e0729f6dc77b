// SPDX-License-Identifier: MIT
#include "nlos/detector/count_sampling.h"

#include "tests/support/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace nlos {
namespace {

constexpr int kDraws = 200'000;
constexpr double kFamilyLevel = 0.001;

/// p-value of draws against probabilities of 0, 1, 2, ...; what is beyond goes into the last cell.
template <class Draw, class LogProbability>
double p_value(int cells, Draw&& draw, LogProbability&& log_probability) {
    std::vector<double> observed(static_cast<std::size_t>(cells), 0.0);
    std::vector<double> expected(observed.size(), 0.0);
    for (int i = 0; i < kDraws; ++i) {
        const auto value = std::min<std::int64_t>(draw(), cells - 1);
        observed[static_cast<std::size_t>(value)] += 1.0;
    }
    double below = 0.0;
    for (std::size_t k = 0; k + 1 < expected.size(); ++k) {
        expected[k] = kDraws * std::exp(log_probability(static_cast<double>(k)));
        below += expected[k];
    }
    expected.back() = std::max(0.0, kDraws - below);
    return test_support::chi_square_p_value(observed, expected);
}

TEST(CountSampling, PoissonNumbersHaveTheirProbabilities) {
    const std::vector<double> means{0.003, 0.7, 9.99, 10.01, 57.3, 1234.5};
    core::Rng rng(test_support::seed_of("PoissonNumbersHaveTheirProbabilities"), 0, 0);
    for (const double mean : means) {
        const int cells = static_cast<int>(mean + 8.0 * std::sqrt(mean) + 8.0);
        const double p = p_value(
            cells,
            [&] { return sample_poisson(rng, mean); },
            [&](double k) { return k * std::log(mean) - mean - std::lgamma(k + 1.0); });
        EXPECT_GT(p, test_support::sidak_level(kFamilyLevel, means.size())) << mean;
    }
    EXPECT_EQ(sample_poisson(rng, 0.0), 0);
}

TEST(CountSampling, BinomialNumbersHaveTheirProbabilities) {
    struct Case {
        std::int64_t trials;
        double probability;
    };
    const std::vector<Case> cases{
        {7, 0.3}, {10'000'000, 3e-7}, {50, 0.45}, {1000, 0.93}, {200'000, 0.002}, {21, 0.5}};
    core::Rng rng(test_support::seed_of("BinomialNumbersHaveTheirProbabilities"), 0, 0);
    for (const auto& [trials, probability] : cases) {
        const auto n = static_cast<double>(trials);
        const double p = probability;
        const double log_p = std::log(p);
        const double log_q = std::log1p(-p);
        const int cells =
            static_cast<int>(std::min(n + 1.0, n * p + 8.0 * std::sqrt(n * p * (1.0 - p)) + 8.0));
        const double value = p_value(
            cells,
            [&] { return sample_binomial(rng, trials, probability); },
            [&](double k) {
                return std::lgamma(n + 1.0) - std::lgamma(k + 1.0) - std::lgamma(n - k + 1.0) +
                       k * log_p + (n - k) * log_q;
            });
        EXPECT_GT(value, test_support::sidak_level(kFamilyLevel, cases.size())) << n << " x " << p;
    }
    EXPECT_EQ(sample_binomial(rng, 5, 0.0), 0);
    EXPECT_EQ(sample_binomial(rng, 5, 1.0), 5);
    EXPECT_EQ(sample_binomial(rng, 0, 0.4), 0);
}

TEST(CountSampling, LargeNumbersHaveTheirMomentsToo) {
    core::Rng rng(test_support::seed_of("LargeNumbersHaveTheirMomentsToo"), 0, 0);
    constexpr int kFew = 20'000;
    const double mean = 3e8;
    double sum = 0.0;
    double squares = 0.0;
    for (int i = 0; i < kFew; ++i) {
        const double z = (static_cast<double>(sample_poisson(rng, mean)) - mean) / std::sqrt(mean);
        sum += z;
        squares += z * z;
    }
    EXPECT_GT(test_support::normal_tail(sum / std::sqrt(double{kFew})), kFamilyLevel / 2.0);
    EXPECT_GT(test_support::normal_tail((squares - kFew) / std::sqrt(2.0 * kFew)),
              kFamilyLevel / 2.0);
}

}  // namespace
}  // namespace nlos
