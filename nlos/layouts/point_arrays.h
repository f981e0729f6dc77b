// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/layouts/layout_files.h"
#include "renderer/core/types.h"

#include <array>
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

}  // namespace nlos
