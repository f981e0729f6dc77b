// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/pictures/picture.h"
#include "nlos/preparation/wall_frame.h"
#include "renderer/core/capture/scan.h"

#include <array>
#include <cstddef>
#include <vector>

namespace nlos {

/// Outer edges of `count` cells of width `pitch` whose first centre is `first`.
std::array<double, 2> cell_edges(double first, double pitch, std::size_t count);

/// Outer edges of cells around evenly spaced centres; a single one is 1 wide.
std::array<double, 2> cell_edges(const std::vector<double>& centres);

/// One value per pixel as the camera sees them, axes in pixels from the top left.
///
/// of_pixels   numbered as core::PinholeCamera says
ImagePanel camera_panel(const core::PinholeCamera& camera, const std::vector<float>& of_pixels);

/// One value per wall point as an eye in front of the wall sees them, axes in the wall's frame [m].
///
/// of_points   in the capture's order
ImagePanel wall_panel(const WallGrid& grid, const std::vector<float>& of_points);

/// Whether values of its pairs make an image: all but lists of wall points.
bool is_picture(const core::Scan& scan);

}  // namespace nlos
