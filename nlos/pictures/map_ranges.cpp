// SPDX-License-Identifier: MIT
#include "nlos/pictures/map_ranges.h"

#include "renderer/core/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace nlos {
namespace {

constexpr double kOutermost = 0.01;  // of the values, beyond an end of the scale
constexpr double kNarrowestDepthRange_m = 0.1;
constexpr double kErrorFraction = 0.02;  // of the true depth

/// Of the finite values; nothing when there are none.
std::optional<double> quantile(std::vector<double> values, double fraction) {
    std::erase_if(values, [](double value) { return !std::isfinite(value); });
    if (values.empty()) return std::nullopt;
    return core::quantile(std::move(values), fraction);
}

std::optional<double> if_positive(std::optional<double> value) {
    return value && *value > 0.0 ? value : std::nullopt;
}

}  // namespace

std::optional<std::array<double, 2>> depth_range_m(const std::vector<double>& depths_m) {
    const std::optional<double> low = quantile(depths_m, kOutermost);
    if (!low) return std::nullopt;
    const double high = *quantile(depths_m, 1.0 - kOutermost);
    const double room = 0.5 * std::max(0.0, kNarrowestDepthRange_m - (high - *low));
    return std::array{*low - room, high + room};
}

std::optional<double> error_limit_m(const std::vector<double>& true_depths_m) {
    std::optional<double> limit = quantile(true_depths_m, 0.5);
    if (limit) *limit *= kErrorFraction;
    return if_positive(limit);
}

std::optional<double> sigma_limit_m(const std::vector<double>& sigma_m) {
    return if_positive(quantile(sigma_m, 1.0 - kOutermost));
}

}  // namespace nlos
