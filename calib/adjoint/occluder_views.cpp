// SPDX-License-Identifier: MIT
#include "calib/adjoint/occluder_views.h"

#include <algorithm>
#include <cmath>

namespace calib {
namespace {

using core::Vec3;

// Rounding, per distance from the wall point: some thousand times that of one operation.
constexpr double kRounding = 1e-12;

}  // namespace

OccluderViews::OccluderViews(const core::TriangleMesh& mesh, const FacetTree& tree)
    : mesh_(mesh), boxes_(tree) {
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3 edge1 = mesh.vertices[b] - mesh.vertices[a];
        const Vec3 edge2 = mesh.vertices[c] - mesh.vertices[a];
        normals_.push_back(Vec3::Zero());
        if (core::has_area(edge1, edge2)) normals_.back() = edge1.cross(edge2).normalized();
    }
}

void OccluderViews::look_from(const MovedWallPoint& wall, std::uint8_t end) {
    wall_ = wall;
    end_ = end;
    vertices_.clear();
    for (const Vec3& vertex : mesh_.vertices) vertices_.push_back(vertex - wall.position);
    boxes_.look(wall.normal, mesh_, vertices_);
    occluders_.clear();
    for (std::size_t facet = 0; facet < normals_.size(); ++facet) {
        occluders_.push_back(make_occluder(facet));
    }
}

OccluderViews::Occluder OccluderViews::make_occluder(std::size_t facet) const {
    const auto& triangle = mesh_.triangles[facet];
    Occluder occluder;
    occluder.vertices = triangle;
    occluder.normal = normals_[facet];
    const double distance = occluder.normal.dot(vertices_[triangle[0]]);
    if (std::abs(distance) <= kRounding * vertices_[triangle[0]].norm()) return occluder;
    occluder.hides = true;
    if (distance < 0.0) {
        occluder.normal = -occluder.normal;
        std::swap(occluder.vertices[1], occluder.vertices[2]);
    }
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3& from = vertices_[occluder.vertices[k]];
        const Vec3& to = vertices_[occluder.vertices[(k + 1) % 3]];
        occluder.edge_normals[k] = from.cross(to - from).normalized();
    }
    return occluder;
}

ElementView OccluderViews::view(const ElementShape& shape) const {
    ElementView view;
    double farthest = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
        view.corners[k] = shape.corners[k] - wall_.position;
        farthest = std::max(farthest, view.corners[k].squaredNorm());
    }
    view.normal = shape.normal;
    view.facing_m = -view.normal.dot(view.corners[0]);
    view.margin_m = kRounding * std::sqrt(farthest);
    return view;
}

// Whether a plane of the tetrahedron of wall point and element separates the occluder from it.
//
// inwards   of the planes through the wall point
bool OccluderViews::is_beside(const Occluder& occluder,
                              const ElementView& element,
                              const std::array<Vec3, 3>& inwards) const {
    const auto& [a, b, c] = occluder.vertices;
    const auto lies_below = [&](const Vec3& normal, double level_m) {
        return std::max({normal.dot(vertices_[a]),
                         normal.dot(vertices_[b]),
                         normal.dot(vertices_[c])}) <= level_m;
    };
    const double side = element.facing_m > 0.0 ? 1.0 : -1.0;
    return lies_below(side * element.normal, element.margin_m - std::abs(element.facing_m)) ||
           std::any_of(inwards.begin(), inwards.end(), [&](const Vec3& normal) {
               return lies_below(normal, element.margin_m);
           });
}

// Returns false where one of the planes has all of the element below it.
bool OccluderViews::shadow_lines(const Occluder& occluder,
                                 const ElementView& element,
                                 std::array<CutLine, 4>& lines) const {
    const auto is_below = [&](const Vec3& height_m) {
        return height_m.maxCoeff() <= element.margin_m;
    };
    const Vec3& origin = vertices_[occluder.vertices[0]];
    for (Eigen::Index i = 0; i < 3; ++i) {
        const Vec3& corner = element.corners[static_cast<std::size_t>(i)];
        lines[3].height_m[i] = occluder.normal.dot(corner - origin);
        for (std::size_t k = 0; k < 3; ++k) {
            lines[k].height_m[i] = occluder.edge_normals[k].dot(corner);
        }
    }
    for (std::size_t k = 0; k < 3; ++k) {
        lines[k].plane = CutPlane::ShadowEdge;
        lines[k].end = end_;
        lines[k].vertices = {occluder.vertices[k], occluder.vertices[(k + 1) % 3], 0};
    }
    lines[3].plane = CutPlane::Occluder;
    lines[3].vertices = occluder.vertices;
    return std::none_of(
        lines.begin(), lines.end(), [&](const CutLine& line) { return is_below(line.height_m); });
}

void OccluderViews::look_at(std::span<const MeshElement> elements) {
    elements_ = elements;
    element_boxes_.clear();
    for (const MeshElement& element : elements) {
        std::array<Vec3, 3> corners;
        for (std::size_t k = 0; k < 3; ++k) {
            corners[k] = element.shape.corners[k] - wall_.position;
        }
        element_boxes_.push_back(boxes_.box_of(corners));
    }
    ViewBox all = element_boxes_.front();
    for (const ViewBox& box : element_boxes_) all.extend(box);
    boxes_.find(all, candidates_);
}

void OccluderViews::remove_shadows(std::size_t index,
                                   const ElementView& view,
                                   PolygonClipper& clipper) const {
    const double side = view.facing_m > 0.0 ? -1.0 : 1.0;
    std::array<Vec3, 3> inwards;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3& from = view.corners[k];
        inwards[k] = side * from.cross(view.corners[(k + 1) % 3] - from).normalized();
    }
    const ViewQuery query(element_boxes_[index]);
    std::array<CutLine, 4> lines;
    for (const std::uint32_t candidate : candidates_) {
        if (!query.matches(boxes_.box_of_facet(candidate))) continue;
        const Occluder& occluder = occluders_[candidate];
        if (candidate == elements_[index].facet || !occluder.hides) continue;
        if (is_beside(occluder, view, inwards)) continue;
        if (!shadow_lines(occluder, view, lines)) continue;
        clipper.remove(lines);
        if (clipper.empty()) return;
    }
}

}  // namespace calib
