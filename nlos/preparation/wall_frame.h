// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"
#include "renderer/core/types.h"

#include <array>
#include <cstddef>
#include <optional>
#include <string>

namespace nlos {

/// Wall points on a planar, rectangular, evenly spaced grid, in the wall's frame.
struct WallGrid {
    std::array<std::size_t, 2> size{};    ///< points along x and y, at least 2 each
    std::array<double, 2> pitch_m{};      ///< distance of neighbours along x and y
    std::array<double, 2> first_m{};      ///< x and y of the point with the lowest coordinates
    std::array<bool, 2> is_descending{};  ///< whether the capture counts down along x or y

    /// Number in the capture of the point at (ix, iy), counted upwards along the frame's axes.
    std::size_t point(std::size_t ix, std::size_t iy) const {
        const std::size_t capture_x = is_descending[0] ? size[0] - 1 - ix : ix;
        const std::size_t capture_y = is_descending[1] ? size[1] - 1 - iy : iy;
        return capture_x * size[1] + capture_y;
    }
    double x_m(std::size_t ix) const { return first_m[0] + static_cast<double>(ix) * pitch_m[0]; }
    double y_m(std::size_t iy) const { return first_m[1] + static_cast<double>(iy) * pitch_m[1]; }
};

/// The relay wall's coordinate frame: origin at the centre of the points, z the plane's normal
/// towards the hidden scene, x along the first axis of the points' grid, right-handed.
struct WallFrame {
    core::Transform world_from_wall = core::Transform::Identity();
    std::array<double, 2> min_m{};  ///< smallest x and y of all wall points, half a cell beyond
    std::array<double, 2> max_m{};  ///< largest x and y of all wall points, half a cell beyond
    std::optional<WallGrid> grid;   ///< of `WallScan::scanned_points`
    std::string why_no_grid;        ///< in words, when `grid` is empty
};

/// Derives the wall's frame from `WallScan::scanned_points`.
///
/// A grid whose axes and normal are left-handed keeps x along the first axis and turns y around, or
/// the other way round when that makes y point up (world y); rows and columns are then
/// `is_descending`.
///
/// returns   frame, footprint, and the grid unless the points are bent, tilted or uneven by more
///           than 2 % of their pitch
/// throws    nothing
WallFrame derive_wall_frame(const core::WallScan& scan);

/// Whether a frame is the world's, as far as people can tell: to 1e-6 m and rad.
bool is_world_frame(const core::Transform& world_from_frame);

/// Where the wall's frame lies in the world: "the world's", or its origin and axes in words.
std::string describe_wall_frame(const core::Transform& world_from_wall);

}  // namespace nlos
