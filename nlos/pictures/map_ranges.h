// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <optional>
#include <vector>

namespace nlos {

// The values at the ends of the colours of maps, the same in every picture and on every page.
// Values that are not finite do not count; nothing is returned where there are no others.

/// All depths but the outermost hundredth at either end; flat things get some room.
std::optional<std::array<double, 2>> depth_range_m(const std::vector<double>& depths_m);

/// The end of a scale of depth errors: a fraction of the median true depth, so that maps of all
/// results of a scene compare. Nothing unless it is positive.
std::optional<double> error_limit_m(const std::vector<double>& true_depths_m);

/// All standard deviations but the highest hundredth. Nothing unless it is positive.
std::optional<double> sigma_limit_m(const std::vector<double>& sigma_m);

}  // namespace nlos
