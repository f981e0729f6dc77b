// SPDX-License-Identifier: MIT
#include "renderer/geometry/planar_patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

namespace renderer {
namespace {

using core::Vec2;
using core::Vec3;

constexpr double kCoplanar = 1e-10;  ///< of the object's size, and of a metre
constexpr double kRoundings = 2.0;   ///< by which corners of one plane lie beside it
constexpr auto kFree = std::numeric_limits<std::uint32_t>::max();  ///< a facet without a patch

// Which facets of the same object share an edge. Corners at the same place count as one: meshes
// repeat vertices where texture coordinates jump.
std::vector<std::vector<std::uint32_t>> neighbours_of(const Scene& scene) {
    const std::span<const Facet> facets = scene.facets();
    using Edge =
        std::tuple<std::uint32_t, std::array<double, 6>, std::uint32_t>;  // object, ends, facet
    std::vector<Edge> edges;
    edges.reserve(3 * facets.size());
    for (std::uint32_t f = 0; f < facets.size(); ++f) {
        // The mesh's own vertices: a facet's corner plus edge may be a bit off.
        const core::TriangleMesh& mesh = scene.object_of(f).mesh;
        const auto& vertices = mesh.triangles[facets[f].triangle];
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3& p = mesh.vertices[vertices[i]];
            const Vec3& q = mesh.vertices[vertices[(i + 1) % 3]];
            std::array<double, 3> first{p.x(), p.y(), p.z()};
            std::array<double, 3> second{q.x(), q.y(), q.z()};
            if (second < first) std::swap(first, second);
            edges.emplace_back(
                facets[f].object,
                std::array{first[0], first[1], first[2], second[0], second[1], second[2]},
                f);
        }
    }
    std::sort(edges.begin(), edges.end());
    std::vector<std::vector<std::uint32_t>> neighbours(facets.size());
    for (std::size_t i = 1; i < edges.size(); ++i) {
        const auto& [object_a, ends_a, a] = edges[i - 1];
        const auto& [object_b, ends_b, b] = edges[i];
        if (object_a != object_b || ends_a != ends_b) continue;
        neighbours[a].push_back(b);
        neighbours[b].push_back(a);
    }
    return neighbours;
}

// Largest distance to the plane at which an object's corners count as lying on it.
std::vector<double> coplanar_distances(const Scene& scene) {
    std::vector<Eigen::AlignedBox3d> boxes;
    for (const Facet& facet : scene.facets()) {
        if (facet.object >= boxes.size()) boxes.resize(facet.object + 1);
        for (const Vec3& corner : facet.corners()) boxes[facet.object].extend(corner);
    }
    std::vector<double> distances;
    for (const auto& box : boxes) {
        const double size = box.isEmpty() ? 0.0 : box.diagonal().norm();
        distances.push_back(
            std::max(kCoplanar * std::min(1.0, size), kRoundings * scene.stated_rounding_m()));
    }
    return distances;
}

}  // namespace

Vec2 barycentric_of(const Facet& facet, const Vec3& position) {
    const Vec3 offset = position - facet.corner;
    const double inverse = 0.5 / facet.area_m2;
    return {inverse * facet.normal.dot(offset.cross(facet.edge2)),
            inverse * facet.normal.dot(facet.edge1.cross(offset))};
}

PlanarPatches::PlanarPatches(const Scene& scene)
    : facets_(scene.facets()), patch_of_facet_(facets_.size(), kFree), cell_begin_{0} {
    const std::span<const Facet> facets = facets_;
    const auto neighbours = neighbours_of(scene);
    const auto distances = coplanar_distances(scene);
    // From the largest facet outwards, every corner against that facet's plane: nothing drifts.
    std::vector<std::uint32_t> order(facets.size());
    std::iota(order.begin(), order.end(), 0U);
    std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return facets[a].area_m2 > facets[b].area_m2;
    });
    std::vector<std::uint32_t> members;
    for (const std::uint32_t seed : order) {
        if (patch_of_facet_[seed] != kFree) continue;
        const Facet& plane = facets[seed];
        const auto is_coplanar = [&](const Facet& facet) {
            const auto corners = facet.corners();
            return std::all_of(corners.begin(), corners.end(), [&](const Vec3& corner) {
                return std::abs(plane.normal.dot(corner - plane.corner)) <= distances[plane.object];
            });
        };
        const auto patch = static_cast<std::uint32_t>(patches_.size());
        members.assign(1, seed);
        patch_of_facet_[seed] = patch;
        for (std::size_t i = 0; i < members.size(); ++i) {
            for (const std::uint32_t next : neighbours[members[i]]) {
                if (patch_of_facet_[next] != kFree || !is_coplanar(facets[next])) continue;
                patch_of_facet_[next] = patch;
                members.push_back(next);
            }
        }
        add_patch(members);
    }
}

void PlanarPatches::add_patch(const std::vector<std::uint32_t>& members) {
    const Facet& seed = facets_[members.front()];
    Patch patch;
    const core::Mat3 frame = seed.world_from_facet();
    patch.plane = seed;
    patch.plane.edge1 = frame.col(0);
    patch.plane.edge2 = frame.col(1);
    patch.num_facets = static_cast<std::uint32_t>(members.size());
    for (const std::uint32_t facet : members) patch.area_m2 += facets_[facet].area_m2;
    if (members.size() > 1) add_grid(patch, members);
    patches_.push_back(patch);
}

void PlanarPatches::add_grid(Patch& patch, const std::vector<std::uint32_t>& members) {
    const auto in_plane = [&](const Vec3& p) {
        return Vec2(patch.plane.edge1.dot(p - patch.plane.corner),
                    patch.plane.edge2.dot(p - patch.plane.corner));
    };
    const auto box_of = [&](std::uint32_t facet) {
        Eigen::AlignedBox2d box;
        for (const Vec3& corner : facets_[facet].corners()) box.extend(in_plane(corner));
        return box;
    };
    Eigen::AlignedBox2d box;
    for (const std::uint32_t facet : members) box.extend(box_of(facet));
    const Vec2 size = box.sizes();
    const double cell = std::sqrt(size.prod() / double(members.size()));
    const auto cells_along = [&](double length) {
        const double most = 4.0 * double(members.size());
        return static_cast<std::uint32_t>(std::clamp(std::ceil(length / cell), 1.0, most));
    };
    patch.columns = cells_along(size.x());
    patch.rows = cells_along(size.y());
    patch.low = box.min();
    patch.cells_per_m = {patch.columns / size.x(), patch.rows / size.y()};
    patch.first_cell = static_cast<std::uint32_t>(cell_begin_.size()) - 1;

    std::vector<std::vector<std::uint32_t>> cells(std::size_t(patch.columns) * patch.rows);
    const auto index_along = [](double position, std::uint32_t count) {
        return static_cast<std::uint32_t>(std::clamp(position, 0.0, double(count - 1)));
    };
    for (const std::uint32_t facet : members) {
        const auto facet_box = box_of(facet);
        const Vec2 low = (facet_box.min() - patch.low).cwiseProduct(patch.cells_per_m);
        const Vec2 high = (facet_box.max() - patch.low).cwiseProduct(patch.cells_per_m);
        for (auto j = index_along(low.y(), patch.rows); j <= index_along(high.y(), patch.rows);
             ++j) {
            for (auto i = index_along(low.x(), patch.columns);
                 i <= index_along(high.x(), patch.columns);
                 ++i) {
                cells[std::size_t(j) * patch.columns + i].push_back(facet);
            }
        }
    }
    for (const auto& list : cells) {
        cell_facets_.insert(cell_facets_.end(), list.begin(), list.end());
        cell_begin_.push_back(static_cast<std::uint32_t>(cell_facets_.size()));
    }
}

std::optional<std::uint32_t> PlanarPatches::locate(std::uint32_t patch,
                                                   const Vec3& position,
                                                   std::uint32_t likely) const {
    if (is_in_triangle(barycentric_of(facets_[likely], position))) return likely;
    const Patch& p = patches_[patch];
    if (p.num_facets == 1) return std::nullopt;
    const Vec3 offset = position - p.plane.corner;
    const Vec2 cell = (Vec2(p.plane.edge1.dot(offset), p.plane.edge2.dot(offset)) - p.low)
                          .cwiseProduct(p.cells_per_m);
    if (!(cell.x() >= 0.0 && cell.y() >= 0.0 && cell.x() <= p.columns && cell.y() <= p.rows)) {
        return std::nullopt;
    }
    const auto column = std::min(static_cast<std::uint32_t>(cell.x()), p.columns - 1);
    const auto row = std::min(static_cast<std::uint32_t>(cell.y()), p.rows - 1);
    const std::size_t index = p.first_cell + std::size_t(row) * p.columns + column;
    for (std::uint32_t i = cell_begin_[index]; i < cell_begin_[index + 1]; ++i) {
        if (is_in_triangle(barycentric_of(facets_[cell_facets_[i]], position))) {
            return cell_facets_[i];
        }
    }
    return std::nullopt;
}

}  // namespace renderer
