// SPDX-License-Identifier: MIT
#pragma once

#include "calib/model/wall_motion.h"
#include "renderer/core/types.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace calib {

/// Which plane meets an element in a line.
enum class CutPlane : std::uint8_t {
    ElementEdge,  ///< none: the line is an edge of the element and moves with it
    ShadowEdge,   ///< through a wall point and two vertices of the mesh
    Occluder,     ///< through the three vertices of a facet
    WallTangent   ///< through a wall point, normal to the wall
};

/// A straight cut through an element.
struct CutLine {
    core::Vec3 height_m;  ///< of the element's corners above the plane
    CutPlane plane = CutPlane::ElementEdge;
    std::uint8_t end = 0;                     ///< of the pair, whose wall point it is
    std::array<std::uint32_t, 3> vertices{};  ///< of the mesh
};

/// A corner of a polygon by its barycentric coordinates in the element: where the line of the edge
/// before it and `line`, that of the edge behind it, meet.
struct PolygonVertex {
    core::Vec3 barycentric;
    std::uint32_t line = 0;
};

/// Cuts an element into convex polygons along straight lines.
///
/// Heights above planes are linear over an element, so that all of this happens in its barycentric
/// coordinates: a line is three numbers, and two lines meet where their cross product points to.
class PolygonClipper {
 public:
    /// Starts with the whole element.
    ///
    /// margin_m   corners of polygons this near to a line lie on it
    void start(double margin_m);

    /// Keeps what lies above the line's plane.
    void keep_above(const CutLine& line);
    /// Takes away what lies above all of the lines' planes.
    void remove(std::span<const CutLine> lines);

    bool empty() const { return ends_.empty(); }
    /// Whether nothing was cut off or apart since start().
    bool is_whole() const;
    std::size_t num_polygons() const { return ends_.size(); }
    /// A convex polygon; its corners go around as those of the element do.
    std::span<const PolygonVertex> polygon(std::size_t i) const {
        const std::size_t begin = i == 0 ? 0 : ends_[i - 1];
        return {vertices_.data() + begin, ends_[i] - begin};
    }
    /// The lines that edges of polygons lie on; the first three are the element's edges.
    std::span<const CutLine> lines() const { return lines_; }

 private:
    using Polygon = std::vector<PolygonVertex>;
    enum class Side { Above, Below };

    void measure(std::span<const PolygonVertex> polygon, std::uint32_t line);
    void append_side(std::span<const PolygonVertex> polygon,
                     std::uint32_t line,
                     Side side,
                     Polygon& target) const;
    void remove_from(std::span<const PolygonVertex> polygon, std::uint32_t first_line);
    void add_next(std::span<const PolygonVertex> polygon);
    void finish_pass();

    double margin_m_ = 0.0;
    std::vector<CutLine> lines_;
    Polygon vertices_;  ///< polygon by polygon
    std::vector<std::size_t> ends_;
    Polygon next_vertices_;
    std::vector<std::size_t> next_ends_;
    std::vector<double> heights_;  ///< of the polygon measured last
    Polygon inside_, rest_;
};

/// From gradients by the corners of polygons to those by the vertices that the cuts go through.
///
/// With D the heights of the element's corners above a line's plane, two lines meet at the
/// barycentric coordinates c / (c_0 + c_1 + c_2), c = D_a x D_b. Heights are triple products of
/// differences of points, up to a factor that moves no line, and their gradients cross products.
class CutPullback {
 public:
    /// lines   of a PolygonClipper, which must outlive this
    void start(std::span<const CutLine> lines);

    /// by_barycentrics   gradients by the barycentric coordinates of a polygon's corners
    void add_polygon(std::span<const PolygonVertex> polygon,
                     std::span<const core::Vec3> by_barycentrics);

    /// Adds the gradients of all polygons so far.
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
