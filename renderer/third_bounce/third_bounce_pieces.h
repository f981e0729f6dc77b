// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture.h"
#include "renderer/core/simd.h"
#include "renderer/geometry/wall_boxes.h"
#include "renderer/scene/scene.h"
#include "renderer/triangle/triangle_histogram.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace renderer {

/// How a piece's weight follows from the geometry terms of its two legs.
enum class PieceKind { Lambertian, Retroreflective, Glossy };

PieceKind kind_of(const Material& material);

/// A flat triangle small enough for the closed-form kernel; positions relative to PieceSet::origin.
struct Piece {
    std::array<core::Vec3, 3> corners;
    std::uint32_t facet = 0;
    std::uint32_t number = 0;  ///< in the order of facets, whatever rounding does to sorting

    core::Vec3 center() const { return (corners[0] + corners[1] + corners[2]) / 3.0; }
    /// Midpoint of the edge from corner i to the next one.
    core::Vec3 midpoint(std::size_t i) const { return 0.5 * (corners[i] + corners[(i + 1) % 3]); }
};

/// Pieces of one kind in the layout of vectorised loops. Nodes 0-2 are corners, 3-5 the middles of
/// the edges that start there, node 6 is the centre.
struct alignas(64) PieceBlock {
    static constexpr std::size_t kSize = TriangleLanes::kSize;
    static constexpr std::size_t kUnitSize = core::Simd::size();  ///< see piece_units.h
    static constexpr std::size_t kUnits = kSize / kUnitSize;
    static constexpr std::size_t kNodes = 7;
    using Lanes = TriangleLanes::Lanes;

    std::array<Lanes, 3> x, y, z;  ///< corners, relative to PieceSet::origin [m]
    Lanes normal_x, normal_y, normal_z;
    Lanes center_x, center_y, center_z;
    Lanes area_m2;
    Lanes rise_m;  ///< the surface lies at most this far above or below the triangle
    std::array<Lanes, 3> squared_edge;  ///< opposite to the corners [m^2]
    Lanes one_sided;                    ///< +-1: only this side of the normal is ever seen; 0: both
    std::array<Lanes, kNodes> reflectance;  ///< at the nodes; albedo/pi or albedo/spot area
    Lanes mean_reflectance;
    Lanes glossy_alpha;  ///< GGX width, set for glossy pieces only
    std::array<std::uint32_t, kSize> facet;
    std::array<std::uint32_t, kSize> random_bits;  ///< from Piece::number
    PieceKind kind = PieceKind::Lambertian;
    std::size_t count = 0;  ///< lanes beyond it repeat lane 0 with area 0
    double longest_edge_m = 0.0;
    /// Spheres that hold the corners of each unit.
    alignas(64) std::array<double, kUnits> unit_x, unit_y, unit_z, unit_radius_m;
};

/// A function's mean over a triangle from its values at a corner, a middle and the centre: exact
/// for cubic ones.
inline constexpr double kShareOfCorner = 1.0 / 20.0;
inline constexpr double kShareOfMiddle = 2.0 / 15.0;
inline constexpr double kShareOfCenter = 9.0 / 20.0;

/// Holds the corners of all pieces of a block; relative to PieceSet::origin.
struct BlockSphere {
    core::Vec3 center;
    double radius_m = 0.0;
};

/// Neighbouring pieces of one object that one shadow ray may stand for: a run of a block's lanes.
struct PieceGroup {
    std::uint32_t block = 0;
    std::uint64_t lanes = 0;  ///< lane i as bit i
};

/// Lists of neighbours: those of item i are items[begin[i] .. begin[i + 1]).
struct NeighbourLists {
    std::vector<std::uint32_t> begin;
    std::vector<std::uint32_t> items;
};

/// The hidden surfaces cut into pieces, piece i in lane i % kSize of block i / kSize.
struct PieceSet {
    core::Vec3 origin = core::Vec3::Zero();  ///< world; keeps precision far from the world's origin
    std::vector<PieceBlock> blocks;
    std::vector<BlockSphere> spheres;  ///< per block, close together in memory
    std::vector<PieceGroup> groups;
    std::vector<std::uint32_t> first_group;  ///< per block, and one past the last
    NeighbourLists piece_neighbours;         ///< pieces that share an edge
    NeighbourLists group_neighbours;
    std::size_t num_pieces = 0;
};

/// Cuts the integrable hidden facets in front of a scan's points into pieces.
class PieceCutter {
 public:
    /// scene, scan   must outlive the cutter
    PieceCutter(const Scene& scene,
                const core::Scan& scan,
                const core::TimeAxis& axis,
                double laser_spot_m2);

    /// Clips facets at the wall's plane and bisects them along their longest edge until length,
    /// falloff and cosines are linear enough over each piece, as seen from the nearest wall point;
    /// leaves out what no pair can see within the axis. Smaller facets are merged where the bins do
    /// not tell them apart.
    ///
    /// tolerance   relative L2 error that the size rule aims at
    PieceSet cut(double tolerance) const;

    /// cut() makes at least this many pieces.
    std::size_t fewest_pieces(double tolerance) const;

 private:
    bool is_small_enough(const LegBounds& legs,
                         const core::Vec3& center,
                         double squared_edge,
                         double tolerance) const;
    void bisect(const Piece& facet, double tolerance, std::vector<Piece>& pieces) const;
    std::vector<Piece> cut_all(double tolerance) const;
    std::vector<std::uint32_t> cluster(std::span<const Piece> pieces, double tolerance) const;

    const Scene& scene_;
    const core::Scan& scan_;
    core::TimeAxis axis_;
    double laser_spot_m2_;
    core::Vec3 origin_;
    bool returns_light_;  ///< retroreflectors do, to some point
    WallBoxes boxes_;
    std::vector<int> visible_sides_;  ///< per object, see closed_surface.h
};

}  // namespace renderer
