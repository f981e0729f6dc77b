// SPDX-License-Identifier: MIT
#include "nlos/pictures/map_ranges.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace nlos {
namespace {

constexpr double kOutermost = 0.01;  // of the values, beyond an end of the scale
constexpr double kNarrowestDepthRange_m = 0.1;
constexpr double kErrorShare = 0.02;  // of the true depth

/// The value below which `share` of the finite values lie.
std::optional<double> percentile(std::vector<double> values, double share) {
    std::erase_if(values, [](double value) { return !std::isfinite(value); });
    if (values.empty()) return std::nullopt;
    const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::nth_element(values.begin(), values.begin() + rank, values.end());
    return values[static_cast<std::size_t>(rank)];
}

std::optional<double> if_positive(std::optional<double> value) {
    return value && *value > 0.0 ? value : std::nullopt;
}

}  // namespace

std::optional<std::array<double, 2>> depth_range_m(const std::vector<double>& depths_m) {
    const std::optional<double> low = percentile(depths_m, kOutermost);
    if (!low) return std::nullopt;
    const double high = *percentile(depths_m, 1.0 - kOutermost);
    const double room = 0.5 * std::max(0.0, kNarrowestDepthRange_m - (high - *low));
    return std::array{*low - room, high + room};
}

std::optional<double> error_limit_m(const std::vector<double>& true_depths_m) {
    std::optional<double> limit = percentile(true_depths_m, 0.5);
    if (limit) *limit *= kErrorShare;
    return if_positive(limit);
}

std::optional<double> sigma_limit_m(const std::vector<double>& sigma_m) {
    return if_positive(percentile(sigma_m, 1.0 - kOutermost));
}

}  // namespace nlos
