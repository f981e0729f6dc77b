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

}  // namespace

ColumnPeak find_peak(std::span<const float> column, std::size_t voxel) {
    const std::size_t highest = uphill(column, voxel);
    ColumnPeak peak{highest, static_cast<double>(highest), 0.0};
    if (highest == 0 || highest + 1 == column.size()) return peak;
    std::array<double, 3> three{column[highest - 1], column[highest], column[highest + 1]};
    double scale = three[1];
    if (three[0] > 0.0 && three[2] > 0.0) {
        for (double& value : three) value = std::log(value);
        scale = 1.0;
    }
    const double curvature = three[0] - 2.0 * three[1] + three[2];
    if (!(curvature < 0.0)) return peak;
    peak.position += std::clamp(0.5 * (three[0] - three[2]) / curvature, -0.5, 0.5);
    peak.curvature = -curvature / scale;
    return peak;
}

}  // namespace nlos
