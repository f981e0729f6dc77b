// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numeric>
#include <random>
#include <vector>

namespace nlos_test {

inline std::vector<float> signed_values(std::size_t count, unsigned seed) {
    std::mt19937 generator(seed);
    std::uniform_real_distribution<float> uniform(-1.0F, 1.0F);
    std::vector<float> values(count);
    for (float& value : values) value = uniform(generator);
    return values;
}

inline double product(const std::vector<float>& a, const std::vector<float>& b) {
    return std::inner_product(
        a.begin(), a.end(), b.begin(), 0.0, std::plus<>(), [](float x, float y) {
            return static_cast<double>(x) * static_cast<double>(y);
        });
}

/// |<A x, y> - <x, A' y>| over what rounding in single precision may make of it.
inline void expect_adjoint(const std::vector<float>& ax,
                           const std::vector<float>& y,
                           const std::vector<float>& x,
                           const std::vector<float>& aty) {
    const double scale = std::sqrt(product(ax, ax) * product(y, y));
    EXPECT_NEAR(product(ax, y), product(x, aty), 1e-6 * scale);
}

}  // namespace nlos_test
