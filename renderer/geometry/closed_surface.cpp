// SPDX-License-Identifier: MIT
#include "renderer/geometry/closed_surface.h"

#include <algorithm>
#include <array>
#include <map>

namespace renderer {
namespace {

using core::TriangleMesh;
using core::Vec3;

// Vertices with equal positions are one: files repeat them where normals or textures differ.
std::vector<std::uint32_t> welded_vertices(const TriangleMesh& mesh) {
    std::map<std::array<double, 3>, std::uint32_t> first;
    std::vector<std::uint32_t> welded;
    for (const Vec3& v : mesh.vertices) {
        const auto index = static_cast<std::uint32_t>(welded.size());
        welded.push_back(first.try_emplace({v.x(), v.y(), v.z()}, index).first->second);
    }
    return welded;
}

// Every edge belongs to exactly two facets, which run along it in opposite directions.
bool is_closed(const TriangleMesh& mesh) {
    const std::vector<std::uint32_t> welded = welded_vertices(mesh);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (const auto& triangle : mesh.triangles) {
        for (std::size_t i = 0; i < 3; ++i) {
            edges.emplace_back(welded[triangle[i]], welded[triangle[(i + 1) % 3]]);
        }
    }
    std::sort(edges.begin(), edges.end());
    if (std::adjacent_find(edges.begin(), edges.end()) != edges.end()) return false;
    return std::all_of(edges.begin(), edges.end(), [&](const auto& edge) {
        return std::binary_search(edges.begin(), edges.end(), std::pair(edge.second, edge.first));
    });
}

// Whose root a vertex is, of those that facets join.
std::uint32_t root_of(std::vector<std::uint32_t>& joined, std::uint32_t vertex) {
    while (joined[vertex] != vertex) vertex = joined[vertex] = joined[joined[vertex]];
    return vertex;
}

// The volume that each connected part of a mesh encloses, negative where normals point inwards.
std::vector<double> signed_volumes(const TriangleMesh& mesh) {
    const std::vector<std::uint32_t> welded = welded_vertices(mesh);
    std::vector<std::uint32_t> joined = welded;
    for (const auto& [a, b, c] : mesh.triangles) {
        for (const std::uint32_t other : {b, c}) {
            joined[root_of(joined, welded[other])] = root_of(joined, welded[a]);
        }
    }
    std::map<std::uint32_t, double> volumes;
    for (const auto& [a, b, c] : mesh.triangles) {
        const std::uint32_t root = root_of(joined, welded[a]);
        const Vec3& apex = mesh.vertices[root];
        volumes[root] += (mesh.vertices[a] - apex)
                             .dot((mesh.vertices[b] - apex).cross(mesh.vertices[c] - apex)) /
                         6.0;
    }
    std::vector<double> values;
    for (const auto& [root, volume] : volumes) values.push_back(volume);
    return values;
}

int visible_side(const Object& object, std::span<const Vec3> path_ends) {
    Eigen::AlignedBox3d box;
    for (const Vec3& vertex : object.mesh.vertices) box.extend(vertex);
    const auto inside = [&](const Vec3& point) { return box.contains(point); };
    if (std::ranges::any_of(path_ends, inside)) return 0;
    if (!is_closed(object.mesh)) return 0;
    const std::vector<double> volumes = signed_volumes(object.mesh);
    if (std::ranges::all_of(volumes, [](double volume) { return volume > 0.0; })) return 1;
    if (std::ranges::all_of(volumes, [](double volume) { return volume < 0.0; })) return -1;
    return 0;
}

}  // namespace

std::vector<int> visible_sides(std::span<const Object> objects, std::span<const Vec3> path_ends) {
    std::vector<int> sides;
    for (const Object& object : objects) sides.push_back(visible_side(object, path_ends));
    return sides;
}

}  // namespace renderer
