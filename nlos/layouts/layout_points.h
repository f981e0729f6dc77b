// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/layouts/capture_settings.h"
#include "nlos/layouts/point_arrays.h"

#include <string>
#include <vector>

namespace nlos {

/// Wall points as a layout places them.
struct PlacedPoints {
    core::WallPoints points;

    /// Which of the points each entry of the histograms' axes belongs to; entries are numbered with
    /// x before y, as points of grids are.
    std::vector<std::size_t> of_entry;
};

/// Reads or makes the points of one kind.
///
/// layout     which they are
/// axes       the histograms' axes that they lie along; none: a single point
/// towards    what normals that the file does not hold look towards; nothing: +z
/// key        of the layout, for messages
/// throws     core::Error naming array, shape and what would fit
PlacedPoints place_points(const LayoutFiles& files,
                          const LayoutPoints& layout,
                          const PointAxes& axes,
                          const CaptureReadSettings& settings,
                          const std::optional<core::Vec3>& towards,
                          const std::string& key);

/// Normals of a plane through the points, or of small planes through neighbours where they lie in
/// none; towards `towards`, or along +z when it is nothing.
std::vector<core::Vec3> fitted_normals(const std::vector<core::Vec3>& positions,
                                       const std::optional<core::Vec3>& towards);

}  // namespace nlos
