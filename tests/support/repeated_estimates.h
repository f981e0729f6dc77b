// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/transient.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace test_support {

// Estimators whose pairs and bins share their noise have no variances of single values: the spread
// is taken from independent renders.

/// What a render says, as few numbers that many paths contribute to; the last one is the total.
using Numbers = std::vector<double>;

/// Sums over pairs, bin by bin, then sums over bins, pair by pair, and the total.
Numbers sums_of(const core::Transient& transient);

/// Means over independent renders, and their squared errors.
struct Estimate {
    Numbers mean;
    Numbers squared_error;
};

/// Renders 24 times, with seeds from a name.
Estimate repeat(const std::function<Numbers(std::uint64_t seed)>& render, const std::string& name);

/// Expects two estimates to agree, number by number, at a family-wise level of 1e-3.
///
/// max_relative_error   that their difference in the total may have: the test's sharpness
void expect_same_means(const Estimate& a, const Estimate& b, double max_relative_error);

}  // namespace test_support
