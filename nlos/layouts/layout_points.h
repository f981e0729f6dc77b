// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/layouts/capture_settings.h"
#include "nlos/layouts/layout_files.h"
#include "renderer/core/types.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace nlos {

/// Axes of a histogram array along which points change: x and y (a grid) or one (a list), in the
/// writer's order.
struct PointAxes {
    std::vector<std::string> names;  ///< "x" and "y", or one that is anything else
    Shape extents;
    bool reversed = false;             ///< whether the layout's axes stand in reverse
    bool first_index_fastest = false;  ///< how a list that stands for a grid runs

    std::size_t count() const;
    bool is_grid() const;
    std::array<std::size_t, 2> grid_extents() const;  ///< x before y
};

// Points that arrays list, one for each entry of the histograms' axes, x before y. All throw
// core::Error naming array, shape and what would fit.

/// Three coordinates per point, or directions, from one array.
std::vector<core::Vec3> read_vectors(const LayoutFiles& files,
                                     const std::string& array,
                                     const LayoutPoints& layout,
                                     const PointAxes& axes);

/// Points from one array of x and one of y: two axes, or two grids.
std::vector<core::Vec3> read_separate(const LayoutFiles& files,
                                      const LayoutPoints& layout,
                                      const PointAxes& axes);

/// A grid between corners: its first point, the last along x, the last along y.
std::vector<core::Vec3> points_between(const LayoutFiles& files,
                                       const std::vector<std::string>& corners,
                                       const PointAxes& axes);

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
