// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/third_bounce/merged_pieces.h"
#include "renderer/third_bounce/third_bounce_pieces.h"

#include <span>
#include <vector>

namespace renderer {

/// What arranging depends on.
struct PieceRules {
    double tolerance = 0.01;  ///< relative L2 error aimed at
    double laser_spot_m2 = 1e-4;
};

/// Merges pieces and arranges them into blocks of neighbours and groups within blocks.
class PieceArranger {
 public:
    /// visible_side   per object, see closed_surface.h
    PieceArranger(const Scene& scene,
                  const core::Scan& scan,
                  const PieceRules& rules,
                  std::vector<int> visible_side);

    /// Call once.
    ///
    /// clusters   of pieces that may be merged, see cluster_pieces()
    PieceSet arrange(std::span<const Piece> pieces, std::span<const std::uint32_t> clusters);

 private:
    struct Range {
        std::size_t begin;
        std::size_t end;
    };
    void append_blocks(const std::vector<MergedPiece>& pieces, PieceKind kind);
    void fill_lane(PieceBlock& block, std::size_t lane, const MergedPiece& piece) const;
    bool may_be_one_group(const PieceBlock& block, Range lanes) const;
    void form_groups(std::size_t block, Range lanes);
    void find_group_neighbours();

    const Scene& scene_;
    PieceRules rules_;
    std::vector<int> visible_side_;
    core::Vec3 scan_center_;
    std::vector<std::uint32_t> piece_ids_;  ///< block * kSize + lane of every merged piece
    PieceSet set_;
};

}  // namespace renderer
