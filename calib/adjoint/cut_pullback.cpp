// SPDX-License-Identifier: MIT
#include "calib/adjoint/polygon_clipper.h"

namespace calib {
namespace {

using core::Vec3;

// Heights of an element's corners above the plane through `origin` that a and b span, relative to
// it; the gradients are those by the normal a x b without its length.
struct SpannedPlane {
    Vec3 origin;
    Vec3 a;
    Vec3 b;

    // Adds gradients by the corners; returns those by a and by b.
    std::array<Vec3, 2> pull(const Vec3& by_heights,
                             const std::array<Vec3, 3>& corners,
                             std::array<Vec3, 3>& by_corners) const {
        const Vec3 normal = a.cross(b);
        const Vec3 scaled = by_heights / normal.norm();
        Vec3 moment = Vec3::Zero();
        for (Eigen::Index i = 0; i < 3; ++i) {
            const auto k = static_cast<std::size_t>(i);
            moment += scaled[i] * (corners[k] - origin);
            by_corners[k] += scaled[i] * normal;
        }
        return {b.cross(moment), moment.cross(a)};
    }
    // What moves with the origin moves against the corners.
    Vec3 by_origin(const Vec3& by_heights) const {
        const Vec3 normal = a.cross(b);
        return -by_heights.sum() / normal.norm() * normal;
    }
};

}  // namespace

void CutPullback::start(std::span<const CutLine> lines) {
    lines_ = lines;
    by_heights_.assign(lines.size(), Vec3::Zero());
}

void CutPullback::add_polygon(std::span<const PolygonVertex> polygon,
                              std::span<const Vec3> by_barycentrics) {
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const std::uint32_t before = polygon[i == 0 ? polygon.size() - 1 : i - 1].line;
        const std::uint32_t behind = polygon[i].line;
        const bool is_element_corner = lines_[before].plane == CutPlane::ElementEdge &&
                                       lines_[behind].plane == CutPlane::ElementEdge;
        if (is_element_corner) continue;
        const Vec3& a = lines_[before].height_m;
        const Vec3& b = lines_[behind].height_m;
        const double along = by_barycentrics[i].dot(polygon[i].barycentric);
        const Vec3 by_cross = (by_barycentrics[i] - Vec3::Constant(along)) / a.cross(b).sum();
        by_heights_[before] += b.cross(by_cross);
        by_heights_[behind] += by_cross.cross(a);
    }
}

void CutPullback::finish(std::span<const MovedWallPoint> ends,
                         const std::array<Vec3, 3>& corners,
                         std::span<const Vec3> vertices,
                         std::array<Vec3, 3>& by_corners,
                         std::span<Vec3> by_vertices) const {
    for (std::size_t line = 0; line < lines_.size(); ++line) {
        const Vec3& by_heights = by_heights_[line];
        if (by_heights == Vec3::Zero()) continue;
        const auto& [u, v, w] = lines_[line].vertices;
        const MovedWallPoint& end = ends[lines_[line].end];
        switch (lines_[line].plane) {
            case CutPlane::ElementEdge:
                break;
            case CutPlane::ShadowEdge: {
                const SpannedPlane plane{
                    end.position, vertices[u] - end.position, vertices[v] - end.position};
                const auto [by_a, by_b] = plane.pull(by_heights, corners, by_corners);
                by_vertices[u] += by_a;
                by_vertices[v] += by_b;
                break;
            }
            case CutPlane::Occluder: {
                const SpannedPlane plane{
                    vertices[u], vertices[v] - vertices[u], vertices[w] - vertices[u]};
                const auto [by_a, by_b] = plane.pull(by_heights, corners, by_corners);
                by_vertices[u] += plane.by_origin(by_heights) - by_a - by_b;
                by_vertices[v] += by_a;
                by_vertices[w] += by_b;
                break;
            }
            case CutPlane::WallTangent:
                for (Eigen::Index i = 0; i < 3; ++i) {
                    by_corners[static_cast<std::size_t>(i)] += by_heights[i] * end.normal;
                }
                break;
        }
    }
}

}  // namespace calib
