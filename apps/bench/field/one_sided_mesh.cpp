// SPDX-License-Identifier: MIT
#include "apps/bench/field/one_sided_mesh.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace apps {
namespace {

// Whether every edge has a triangle on either side.
bool is_closed(const core::TriangleMesh& mesh) {
    // Vertices that stand at one position are one.
    std::map<std::array<double, 3>, std::uint32_t> positions;
    std::vector<std::uint32_t> position_of;
    for (const core::Vec3& v : mesh.vertices) {
        const auto number = static_cast<std::uint32_t>(positions.size());
        position_of.push_back(positions.try_emplace({v.x(), v.y(), v.z()}, number).first->second);
    }
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> surplus;  // of an edge over its reverse
    for (const auto& triangle : mesh.triangles) {
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t a = position_of[triangle[i]];
            const std::uint32_t b = position_of[triangle[(i + 1) % 3]];
            surplus[std::minmax(a, b)] += a < b ? 1 : -1;
        }
    }
    return std::ranges::all_of(surplus, [](const auto& edge) { return edge.second == 0; });
}

}  // namespace

core::TriangleMesh turned_to_wall(core::TriangleMesh mesh, const core::Vec3& wall_normal) {
    if (is_closed(mesh)) return mesh;
    for (auto& triangle : mesh.triangles) {
        const core::Vec3& a = mesh.vertices[triangle[0]];
        const core::Vec3 normal =
            (mesh.vertices[triangle[1]] - a).cross(mesh.vertices[triangle[2]] - a);
        if (normal.dot(wall_normal) > 0.0) std::swap(triangle[1], triangle[2]);
    }
    return mesh;
}

}  // namespace apps
