// SPDX-License-Identifier: MIT
#include "nlos/preparation/checks/wall_unit.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace nlos {

std::optional<std::string> wall_unit_mistake(const core::Capture& capture) {
    constexpr double kFarthest = 10.0;  // extent of the wall over the longest path
    constexpr double kLargest_m = 5.0;  // below that, bins may as well be too narrow
    constexpr double kUsual = 0.5;
    constexpr std::array kUnits{std::pair(1e-3, "millimetres"),
                                std::pair(1e-2, "centimetres"),
                                std::pair(0.0254, "inches")};
    const core::ScanExtent extent = core::scan_extent(capture.scan.wall());
    const double diagonal_m = std::hypot(extent.size_m[0], extent.size_m[1]);
    const double ratio = diagonal_m / capture.time_axis.opl_end_m();
    if (!(ratio > kFarthest) || diagonal_m < kLargest_m) return std::nullopt;
    const auto distance = [&](const auto& unit) {
        return std::abs(std::log(ratio * unit.first / kUsual));
    };
    const auto& [factor, name] = *std::ranges::min_element(kUnits, {}, distance);
    return fmt::format(
        "wall points extend over {:.4g} x {:.4g} m where no path is longer than {:.3g} m: they "
        "look like {}: --set capture.wall_size_m=[{:.6g},{:.6g}]",
        extent.size_m[0],
        extent.size_m[1],
        capture.time_axis.opl_end_m(),
        name,
        factor * extent.size_m[0],
        factor * extent.size_m[1]);
}

}  // namespace nlos
