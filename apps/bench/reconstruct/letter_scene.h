// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture.h"
#include "renderer/core/depth_map.h"

namespace apps {

/// The letter T that methods are compared on: 12 mm patches, 0.7 m before a wall of 1 m with
/// 64 x 64 points and 512 bins of 8 mm, light without cosines, 1 / (r_l^2 r_s^2).
///
/// pattern   confocal, or single with the laser on the wall's centre
core::Capture letter_t_capture(core::ScanPattern pattern);

/// Its true depth: |x| < 66 mm with |y| < 306 mm, or |x| < 306 mm with 174 mm < y < 306 mm.
core::DepthMap letter_t_depth(const core::Transform& world_from_wall,
                              const std::vector<double>& x_m,
                              const std::vector<double>& y_m);

}  // namespace apps
