// SPDX-License-Identifier: MIT
#pragma once

#include "calib/adjoint/piece_cutter.h"
#include "calib/forward/wall_motion.h"

#include <array>
#include <span>
#include <vector>

namespace calib {

/// From gradients by the corners of pieces to those by the vertices that the cuts go through.
///
/// With D the heights of the element's corners above a line's plane, two lines meet at the
/// barycentric coordinates c / (c_0 + c_1 + c_2), c = D_a x D_b. Heights are triple products of
/// differences of points, up to a factor that moves no line, and their gradients cross products.
class CutPullback {
 public:
    /// lines   of a PieceCutter, which must outlive this
    void start(std::span<const CutLine> lines);

    /// by_shares   gradients by the barycentric coordinates of a piece's corners
    void add_piece(std::span<const PieceVertex> piece, std::span<const core::Vec3> by_shares);

    /// Adds the gradients of all pieces so far.
    ///
    /// ends         the pair's wall points
    /// corners      of the element
    /// vertices     of the mesh
    /// by_corners   gradients by the element's corners
    /// by_vertices  gradients by the mesh's vertices
    void finish(std::span<const MovedWallPoint> ends,
                const std::array<core::Vec3, 3>& corners,
                std::span<const core::Vec3> vertices,
                std::array<core::Vec3, 3>& by_corners,
                std::span<core::Vec3> by_vertices) const;

 private:
    std::span<const CutLine> lines_;
    std::vector<core::Vec3> by_heights_;  ///< per line
};

}  // namespace calib
