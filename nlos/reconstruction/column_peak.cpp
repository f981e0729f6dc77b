// SPDX-License-Identifier: MIT
#include "nlos/reconstruction/column_peak.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace nlos {
namespace {

std::size_t uphill(std::span<const float> column, std::size_t voxel) {
    constexpr int kReach = 3;
    for (int step = 0; step < kReach; ++step) {
        std::size_t higher = voxel;
        if (voxel > 0 && column[voxel - 1] > column[higher]) higher = voxel - 1;
        if (voxel + 1 < column.size() && column[voxel + 1] > column[higher]) higher = voxel + 1;
        if (higher == voxel) break;
        voxel = higher;
    }
    return voxel;
}

/// The vertex of the parabola through the logarithms of three neighbouring values, through the
/// values themselves where one is not positive.
struct Vertex {
    double offset = 0.0;     ///< from the middle [voxels]
    double curvature = 0.0;  ///< turned positive; 0 where there is no vertex
};

Vertex vertex(std::array<double, 3> values) {
    double scale = values[1];
    if (std::ranges::all_of(values, [](double value) { return value > 0.0; })) {
        for (double& value : values) value = std::log(value);
        scale = 1.0;
    }
    const double curvature = values[0] - 2.0 * values[1] + values[2];
    if (!(curvature < 0.0)) return {};
    return {std::clamp(0.5 * (values[0] - values[2]) / curvature, -0.5, 0.5), -curvature / scale};
}

/// The same after smoothing by (1, 2, 1).
Vertex smoothed_vertex(std::span<const float> column, std::size_t highest) {
    const auto at = [&](int step) {
        const auto last = static_cast<std::ptrdiff_t>(column.size()) - 1;
        const auto voxel =
            std::clamp<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(highest) + step, 0, last);
        return static_cast<double>(column[static_cast<std::size_t>(voxel)]);
    };
    const auto smooth = [&](int step) { return at(step - 1) + 2.0 * at(step) + at(step + 1); };
    int middle = 0;
    if (smooth(-1) > smooth(middle)) middle = -1;
    if (smooth(1) > smooth(middle)) middle = 1;
    Vertex result = vertex({smooth(middle - 1), smooth(middle), smooth(middle + 1)});
    result.offset += middle;
    return result;
}

}  // namespace

ColumnPeak find_peak(std::span<const float> column, std::size_t voxel) {
    const std::size_t highest = uphill(column, voxel);
    ColumnPeak peak{highest, static_cast<double>(highest), 0.0};
    if (highest == 0 || highest + 1 == column.size()) return peak;
    const double before = column[highest - 1];
    const double after = column[highest + 1];
    constexpr double kNarrow = 2.0;  // [1 / voxels^2]: a Gaussian of 0.7 voxels
    Vertex top = vertex({before, column[highest], after});
    if (std::min(before, after) <= 0.0 || top.curvature > kNarrow) {
        top = smoothed_vertex(column, highest);
    }
    peak.position += top.offset;
    peak.curvature = top.curvature;
    return peak;
}

}  // namespace nlos
