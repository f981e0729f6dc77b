// SPDX-License-Identifier: MIT
#include "renderer/core/capture/scan_extent.h"

#include <algorithm>

namespace core {

ScanExtent scan_extent(const Scan& scan) {
    const WallPoints& points =
        scan.sensing.size() >= scan.illumination.size() ? scan.sensing : scan.illumination;
    const Vec3& first = points.positions.front();
    ScanExtent extent;
    if (points.grid) {
        const auto [nx, ny] = *points.grid;
        const Vec3 along_x = points.positions[(nx - 1) * ny] - first;
        const Vec3 along_y = points.positions[ny - 1] - first;
        if (along_x.norm() > 0.0) extent.axes[0] = along_x.normalized();
        if (along_y.norm() > 0.0) extent.axes[1] = along_y.normalized();
    }
    for (int i = 0; i < 2; ++i) {
        double low = extent.axes[i].dot(first);
        double high = low;
        for (const Vec3& position : points.positions) {
            low = std::min(low, extent.axes[i].dot(position));
            high = std::max(high, extent.axes[i].dot(position));
        }
        extent.middle_m[i] = 0.5 * (low + high);
        extent.size_m[i] = high - low;
    }
    return extent;
}

}  // namespace core
