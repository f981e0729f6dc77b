// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"

#include <array>

namespace core {

/// How far a scan's points extend along two axes: those of their grid, or x and y of the world for
/// a list. The longer list of points decides, sensing points when both are equal.
struct ScanExtent {
    std::array<Vec3, 2> axes{Vec3::UnitX(), Vec3::UnitY()};
    std::array<double, 2> middle_m{};  ///< along each axis
    std::array<double, 2> size_m{};    ///< first to last
};

/// scan   of at least one point of each kind; no image of a camera
ScanExtent scan_extent(const Scan& scan);

}  // namespace core
