// SPDX-License-Identifier: MIT
#include "renderer/core/depth_map.h"

namespace core {

PointCloud surface_points(const DepthMap& depth) {
    PointCloud points;
    for (std::size_t ix = 0; ix < depth.x_m.size(); ++ix) {
        for (std::size_t iy = 0; iy < depth.y_m.size(); ++iy) {
            const std::size_t i = depth.index(ix, iy);
            if (!depth.is_foreground(i)) continue;
            points.positions.push_back(depth.point_world(ix, iy));
            if (!depth.normals.empty()) points.normals.push_back(depth.normals[i]);
        }
    }
    return points;
}

}  // namespace core
