// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/depth_map.h"

#include <cstddef>
#include <vector>

namespace core {

/// A surface within the footprint of a column.
struct ColumnSurface {
    double depth_m = 0.0;   ///< mean over the part of the footprint in which it is seen
    Vec3 normal{0, 0, 0};   ///< mean of the same, unit, towards the wall; 0 when unknown
    double albedo = 1.0;    ///< mean of the same; 1 when unknown
    double fraction = 0.0;  ///< of the footprint in which it is seen along the wall's normal
};

/// The surface that reconstructions are scored against: what the wall sees, over the whole
/// footprint of every column and as evenly spaced samples.
///
/// A column that looks at the centre of its footprint alone misses what falls between columns, and
/// has one depth where an edge has two. So a column here has all surfaces that are anywhere in its
/// footprint, those behind another included that other points of the wall see past it; those nearer
/// together than half a column's width are one.
struct TrueSurface {
    std::vector<std::vector<ColumnSurface>> columns;  ///< [x][y], by depth; empty: background
    DepthMap main;             ///< per column the surface seen in most of its footprint
    PointCloud samples;        ///< per_side x per_side of each column's footprint [world]
    std::size_t per_side = 1;  ///< of samples, along x and along y
    double lost_at_half =
        0.0;  ///< fraction of the samples whose surface a view half as fine misses

    /// One surface per column, seen everywhere in it: a depth map as it is measured.
    TrueSurface(DepthMap measured);  // NOLINT(google-explicit-constructor)

    /// Columns of `per_side` x `per_side` samples each.
    ///
    /// layers   what is seen along the wall's normal, and surfaces behind it; samples at the
    /// centres
    ///          of equal parts of the footprints, per_side times as many as there are columns along
    ///          x and along y
    TrueSurface(const std::vector<DepthMap>& layers, std::size_t per_side);

    /// Fraction of a column's footprint in which a surface is seen along the wall's normal.
    double covered(std::size_t column) const;
};

/// The columns' true surfaces that are nearest to what was found: to `found` where it has a depth,
/// else the main ones.
///
/// found   on the same columns, or without any
DepthMap nearest_surfaces(const TrueSurface& truth, const DepthMap& found);

/// Centres of `per_side` equal parts of each cell, cells being as wide as neighbouring centres are
/// apart; a single cell, whose width nobody knows, has all parts at its centre.
std::vector<double> parts_of_cells(const std::vector<double>& centres_m, std::size_t per_side);

/// The distance of evenly spaced centres; 0 for a single one.
double spacing_m(const std::vector<double>& centres_m);

/// The surface of a depth map at `per_side` x `per_side` points of each column's footprint, sloped
/// as neighbouring columns say and never steeper than to the nearer of two [world].
PointCloud dense_points(const DepthMap& depth, std::size_t per_side);

}  // namespace core
