// SPDX-License-Identifier: MIT
#include "apps/bench/field/one_sided_mesh.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace apps {
namespace {

const core::Vec3 kWallNormal = core::Vec3::UnitZ();

// How many triangles have their normal on the wall's side of them.
int count_turned_to_wall(const core::TriangleMesh& mesh) {
    int count = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
        const core::Vec3 area =
            core::triangle_area_vector(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]);
        count += area.dot(kWallNormal) < 0.0 ? 1 : 0;
    }
    return count;
}

TEST(OneSidedMesh, SheetsTurnEveryTriangleToTheWall) {
    core::TriangleMesh sheet;
    sheet.vertices = {{0, 0, 1}, {1, 0, 1}, {1, 1, 1.1}, {0, 1, 1.1}};
    sheet.triangles = {{0, 1, 2}, {0, 3, 2}};  // one either way
    EXPECT_EQ(count_turned_to_wall(sheet), 1);
    EXPECT_EQ(count_turned_to_wall(turned_to_wall(sheet, kWallNormal)), 2);
    EXPECT_EQ(count_turned_to_wall(turned_to_wall(sheet, -kWallNormal)), 0);
}

TEST(OneSidedMesh, ClosedOnesStayAsTheyAre) {
    // A tetrahedron with three vertices for every face, as glTF keeps flat shading.
    const std::vector<core::Vec3> corners{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {0, 0, 2}};
    core::TriangleMesh mesh;
    for (const auto& face :
         std::vector<std::array<int, 3>>{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}) {
        const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
        for (const int corner : face)
            mesh.vertices.push_back(corners[static_cast<std::size_t>(corner)]);
        mesh.triangles.push_back({first, first + 1, first + 2});
    }
    EXPECT_EQ(turned_to_wall(mesh, kWallNormal).triangles, mesh.triangles);
}

}  // namespace
}  // namespace apps
