// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace test_support {

/// Seed of a test: a hash of its name, so that seeds differ and never change.
std::uint64_t seed_of(std::string_view test_name);

/// Probability that a chi-square variable with `degrees` degrees of freedom exceeds `value`.
double chi_square_tail(double value, double degrees);

/// Probability that |z| of a standard normal variable exceeds |value|.
double normal_tail(double value);

/// Smallest p-value that one of `num_tests` tests may show at family-wise level `level` (Sidak).
double sidak_level(double level, std::size_t num_tests);

/// p-value of observed counts against expected ones; cells with fewer than 5 expected are pooled.
double chi_square_p_value(std::span<const double> observed, std::span<const double> expected);

double sum_of(std::span<const float> values);
double sum_of(std::span<const double> values);

/// sqrt(sum (a-b)^2 / sum b^2).
double relative_l2(std::span<const float> a, std::span<const float> b);
double relative_l2(std::span<const double> a, std::span<const double> b);

}  // namespace test_support
