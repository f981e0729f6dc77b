// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/third_bounce/third_bounce_pieces.h"

#include <cstdint>
#include <functional>
#include <span>
#include <utility>
#include <vector>

namespace renderer {

/// A piece as it is integrated: itself, or a triangle that stands for several pieces with the same
/// area, centroid and second moments in its plane.
struct MergedPiece {
    Piece triangle;  ///< with one of the facets
    core::Vec3 normal;
    double area_m2 = 0.0;
    double rise_m = 0.0;  ///< the surface lies at most this far above or below the triangle's plane
};

/// Merged pieces, and where each of the pieces went.
struct MergedPieces {
    std::vector<MergedPiece> pieces;
    std::vector<std::uint32_t> merged_of;  ///< per piece, index into `pieces`
};

/// What may be a cluster.
struct ClusterLimits {
    double diameter_m = 0.0;
    double squared_tilt = 0.0;  ///< mean of |normal - mean normal|^2
};

/// Splits the pieces of each object at medians until each part may be merged; pieces of glossy and
/// textured objects stay single.
///
/// pieces              those of an object in a row
/// may_be_merged       asked for a part's bounding sphere when it keeps the limits
/// returns             a cluster number per piece, counted from 0
std::vector<std::uint32_t> cluster_pieces(
    const Scene& scene,
    std::span<const Piece> pieces,
    const ClusterLimits& limits,
    const std::function<bool(const core::Vec3& center, double diameter_m)>& may_be_merged);

/// Merges pieces of the same cluster that hang together.
///
/// clusters   per piece
/// touching   pairs of pieces, see touching_pieces()
MergedPieces merge_pieces(const Scene& scene,
                          std::span<const Piece> pieces,
                          std::span<const std::uint32_t> clusters,
                          std::span<const std::pair<std::uint32_t, std::uint32_t>> touching);

}  // namespace renderer
