// SPDX-License-Identifier: MIT
#include "calib/adjoint/facet_tree.h"

#include "renderer/geometry/median_split.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace calib {
namespace {

using core::Vec3;

constexpr std::uint32_t kFacetsPerLeaf = 4;

// What is nearer to the wall than this part of its distance has no place in the picture.
constexpr double kLowestElevation = 1e-9;

}  // namespace

FacetTree::FacetTree(const core::TriangleMesh& mesh) : order_(mesh.triangles.size()) {
    if (order_.empty()) return;
    std::vector<Vec3> centers;
    centers.reserve(order_.size());
    for (const auto& [a, b, c] : mesh.triangles) {
        centers.emplace_back((mesh.vertices[a] + mesh.vertices[b] + mesh.vertices[c]) / 3.0);
    }
    std::iota(order_.begin(), order_.end(), 0U);
    nodes_.reserve(order_.size());
    nodes_.emplace_back();
    build(centers, 0, 0, static_cast<std::uint32_t>(order_.size()));
}

void FacetTree::build(const std::vector<Vec3>& centers,
                      std::uint32_t node,
                      std::uint32_t first,
                      std::uint32_t count) {
    if (count <= kFacetsPerLeaf) {
        nodes_[node] = {first, count};
        return;
    }
    const std::span<std::uint32_t> facets(order_.data() + first, count);
    const auto center_of = [&](std::uint32_t facet) -> const Vec3& { return centers[facet]; };
    Eigen::AlignedBox3d box;
    for (const std::uint32_t facet : facets) box.extend(centers[facet]);
    const std::uint32_t half = count / 2;
    renderer::split_along_longest_side(facets, half, box, center_of);
    const auto child = static_cast<std::uint32_t>(nodes_.size());
    nodes_[node] = {child, 0};
    nodes_.resize(nodes_.size() + 2);
    build(centers, child, first, half);
    build(centers, child + 1, first + half, count - half);
}

void ViewBoxes::look(const Vec3& wall_normal,
                     const core::TriangleMesh& mesh,
                     std::span<const Vec3> vertices) {
    wall_from_world_ =
        core::frame_from_normal(wall_normal, wall_normal.unitOrthogonal()).transpose();
    facets_.clear();
    for (const auto& [a, b, c] : mesh.triangles) {
        facets_.push_back(box_of({vertices[a], vertices[b], vertices[c]}));
    }
    const auto nodes = tree_.nodes();
    nodes_.resize(nodes.size());
    for (std::size_t i = nodes.size(); i-- > 0;) {
        const FacetTree::Node& node = nodes[i];
        if (node.count == 0) {
            nodes_[i] = nodes_[node.first];
            nodes_[i].extend(nodes_[node.first + 1]);
            continue;
        }
        nodes_[i] = facets_[tree_.order()[node.first]];
        for (std::uint32_t k = 1; k < node.count; ++k) {
            nodes_[i].extend(facets_[tree_.order()[node.first + k]]);
        }
    }
}

ViewBox ViewBoxes::box_of(const std::array<Vec3, 3>& corners) const {
    ViewBox box;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 p = wall_from_world_ * corners[k];
        const double u = p.x() / p.z();
        const double v = p.y() / p.z();
        ViewBox corner{{u, v, p.z(), -u, -v, -p.z()}};
        if (!(p.z() > kLowestElevation * p.norm())) {
            constexpr double kAnywhere = -std::numeric_limits<double>::infinity();
            for (const std::size_t i : {0, 1, 3, 4}) corner.bounds[i] = kAnywhere;
        }
        if (k == 0) {
            box = corner;
        } else {
            box.extend(corner);
        }
    }
    return box;
}

void ViewBoxes::find(const ViewBox& box, std::vector<std::uint32_t>& found) const {
    found.clear();
    const auto nodes = tree_.nodes();
    if (nodes.empty()) return;
    const ViewQuery query(box);
    constexpr std::size_t kMaxDepth = 64;  // halves of at most 2^32 facets
    std::array<std::uint32_t, kMaxDepth> stack{};
    std::size_t depth = 1;
    while (depth > 0) {
        const std::uint32_t index = stack[--depth];
        if (!query.matches(nodes_[index])) continue;
        const FacetTree::Node& node = nodes[index];
        if (node.count == 0) {
            stack[depth++] = node.first;
            stack[depth++] = node.first + 1;
            continue;
        }
        for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
            const std::uint32_t facet = tree_.order()[k];
            if (query.matches(facets_[facet])) found.push_back(facet);
        }
    }
    std::sort(found.begin(), found.end());
}

}  // namespace calib
