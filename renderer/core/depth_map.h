// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/mesh.h"
#include "renderer/core/types.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace core {

/// What an orthographic view from the wall sees: depth along the wall's normal.
///
/// Columns sit at (x_m[i], y_m[j]) in the wall's frame; values are stored [i][j], y fastest.
struct DepthMap {
    std::vector<double> x_m;
    std::vector<double> y_m;
    std::vector<double> depth_m;        ///< NaN = background
    std::vector<Vec3> normals;          ///< world, unit, towards the wall; empty when unknown
    std::vector<double> albedo;         ///< of the surface seen; empty when unknown
    std::vector<std::uint32_t> object;  ///< whose surface is seen; empty when unknown
    Transform world_from_wall = Transform::Identity();

    DepthMap() = default;
    DepthMap(std::vector<double> x, std::vector<double> y)
        : x_m(std::move(x)),
          y_m(std::move(y)),
          depth_m(x_m.size() * y_m.size(), std::numeric_limits<double>::quiet_NaN()) {}

    std::size_t index(std::size_t ix, std::size_t iy) const { return ix * y_m.size() + iy; }
    bool is_foreground(std::size_t index) const { return !std::isnan(depth_m[index]); }

    /// The surface point of a foreground column [m, world].
    Vec3 point_world(std::size_t ix, std::size_t iy) const {
        return world_from_wall * Vec3(x_m[ix], y_m[iy], depth_m[index(ix, iy)]);
    }
};

/// The foreground of a depth map as points, with normals where they are known [world].
inline PointCloud surface_points(const DepthMap& depth) {
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
