// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/compare/metrics.h"
#include "nlos/reconstruction/reconstruction.h"
#include "renderer/core/capture/capture.h"
#include "renderer/core/mesh.h"
#include "renderer/core/true_surface.h"

#include <optional>
#include <string>
#include <vector>

namespace nlos {

/// Scores a reconstructed volume against the surface that the wall sees.
///
/// Depth: each column's is compared with the nearest of the true surfaces in its footprint, so that
/// either side of an edge is right; depth_coverage is the fraction of the true area in whose
/// columns a depth was found. Masks: the reconstructed ones are the columns that `result.depth`
/// gives a depth, and for mask_iou those whose maximum projection exceeds 20 % of its maximum; a
/// column in whose footprint any surface is seen is rightly in them, and one that is not counts as
/// missed by the part of it that is covered. Points: both surfaces are sampled alike,
/// `truth.per_side` x `truth.per_side` per column, so that scores of different grids compare. The
/// true image is the albedo seen, background 0, divided by its maximum.
///
/// result       volume with depth; its normals, if any, point towards the wall
/// truth        of exactly the volume's columns, see renderer::trace_true_surface(); or a depth map
/// threshold_m  distance that counts as a match of points [m]; nothing: a voxel diagonal
/// returns  no value for a score that lacks its data: an empty mask, no points, no positive voxel
/// throws   core::Error when the columns or the walls differ
Metrics compare_to_truth(const Reconstruction& result,
                         const core::TrueSurface& truth,
                         std::optional<double> threshold_m = std::nullopt);

/// Why scores against a truth would change with its resolution; nothing where they would not.
std::optional<std::string> coarse_truth_warning(const core::TrueSurface& truth);

/// Scores surface points against surface samples of the truth (Chamfer distance; completeness,
/// accuracy and their harmonic mean, the F-score, also within 10 mm and within the data's
/// resolution; normals).
///
/// result, truth  points in the same frame; normals are compared at nearest neighbours,
///                whichever side they point to
/// threshold_m    distance that counts as a match [m]
/// resolution_m   of the data, see Reconstruction; nothing: unknown
/// returns        no score when either has no point
/// source         F-score [Knapitsch2017]
Metrics compare_points(const core::PointCloud& result,
                       const core::PointCloud& truth,
                       double threshold_m,
                       std::optional<double> resolution_m = std::nullopt);

/// Scores one volume against another on the same grid: projections, depths, points, voxels.
///
/// For mask_iou both masks are at 20 % of their own maximum; peak_distance_m is the distance of the
/// two brightest voxels; rel_l2 and rel_mse compare the voxels as they are, without scaling.
///
/// throws    core::Error when the grids or the walls differ
Metrics compare_volumes(const Reconstruction& result,
                        const Reconstruction& reference,
                        std::optional<double> threshold_m = std::nullopt);

/// Relative differences of two captures; rel_l2 = |a-b|/|b|, rel_mse its square. Pairs are those of
/// the same wall points, in whatever order they stand; where the points differ, those of one index.
/// Only bins count that both observed.
///
/// throws    core::Error when shapes, units or time axes differ
Metrics compare_captures(const core::Capture& result, const core::Capture& reference);

/// Why relative differences of two captures say little: scans that differ, bins that were not
/// observed, captures without light.
/// A sentence each, for people.
std::vector<std::string> comparison_warnings(const core::Capture& result,
                                             const core::Capture& reference);

}  // namespace nlos
