// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace core {

/// The value that `rank` others come before in order, of more values than that.
template <class T, class Projection = std::identity>
T value_at_rank(std::vector<T> values, std::size_t rank, Projection by = {}) {
    const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank);
    std::ranges::nth_element(values, at, {}, by);
    return *at;
}

/// The largest value that at most this fraction of the others lie below, in [0, 1]; of at least
/// one.
template <class T, class Projection = std::identity>
T quantile(std::vector<T> values, double fraction, Projection by = {}) {
    const double last = static_cast<double>(values.size() - 1);
    return value_at_rank(std::move(values), static_cast<std::size_t>(fraction * last), by);
}

/// The value in the middle of at least one; of an even number, the mean of the two there.
inline double median(std::vector<double> values) {
    std::ranges::sort(values);
    const std::size_t half = values.size() / 2;
    return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

/// The same, but of an even number the upper of the two: one of the values themselves.
template <class T>
T upper_median(std::vector<T> values) {
    const std::size_t half = values.size() / 2;
    return value_at_rank(std::move(values), half);
}

/// Sum of all values squared, in order.
inline double squared_norm(std::span<const float> values) {
    double sum = 0.0;
    for (const float value : values) sum += double{value} * double{value};
    return sum;
}

}  // namespace core
