// SPDX-License-Identifier: MIT
// What `nlos bench render --part accuracy` measures, on fewer scenes.
#include "apps/bench/render/third_bounce.h"
#include "apps/shapes/grid_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

namespace apps {
namespace {

TEST(TargetError, IsHonouredOnRandomScenesAndNotFarUndercut) {
    constexpr int kScenes = 6;
    const std::vector<TargetError> errors = bench_target_errors(kScenes, {});
    ASSERT_EQ(errors.size(), 3U * kScenes);
    EXPECT_LE(std::ranges::count(errors, false, &TargetError::met), 1);
    EXPECT_LE(std::ranges::count(errors, true, &TargetError::is_far_below), 1);
    for (const TargetError& error : errors) {
        EXPECT_GT(error.rel_l2, 0.0);
        EXPECT_LT(error.rel_l2, 2.0 * error.target_error) << "scene " << error.scene;
    }
}

TEST(Agreement, OfIntegratorAndPathsHoldsBinByBin) {
    const std::vector<Agreement> agreements =
        bench_agreement({NLOS_SOURCE_DIR "/scenes/letter/scene.json"}, {});
    ASSERT_EQ(agreements.size(), 3U);
    for (const Agreement& agreement : agreements) {
        EXPECT_GT(agreement.num_bins, 200U) << agreement.pattern;
        EXPECT_GT(agreement.p_value, 1e-3) << agreement.pattern;
        EXPECT_GT(agreement.within_95, 0.93) << agreement.pattern;
        EXPECT_NEAR(agreement.energy_ratio, 1.0, 4.0 * agreement.energy_sigma) << agreement.pattern;
    }
}

TEST(GridMesh, OfASphereIsClosedAndFacesOneWay) {
    constexpr int kCells = 6;
    const core::Vec3 center(0.1, -0.2, 0.7);
    const core::TriangleMesh mesh = make_sphere_mesh(center, 0.5, kCells);
    EXPECT_EQ(mesh.triangles.size(), 2U * kCells * kCells);
    // Vertices at the rim of the grid coincide in pairs; then every edge has two triangles, which
    // run along it in opposite directions.
    std::vector<std::size_t> first_there;
    for (const core::Vec3& vertex : mesh.vertices) {
        EXPECT_NEAR((vertex - center).norm(), 0.5, 1e-12);
        const auto same = std::ranges::find_if(
            mesh.vertices, [&](const core::Vec3& other) { return (other - vertex).norm() < 1e-9; });
        first_there.push_back(static_cast<std::size_t>(same - mesh.vertices.begin()));
    }
    std::map<std::pair<std::size_t, std::size_t>, int> edges;
    for (const auto& triangle : mesh.triangles) {
        const auto corner = [&](std::size_t i) { return first_there[triangle[i % 3]]; };
        for (std::size_t i = 0; i < 3; ++i) ++edges[{corner(i), corner(i + 1)}];
        const core::Vec3 area = core::triangle_area_vector(
            mesh.vertices[triangle[0]], mesh.vertices[triangle[1]], mesh.vertices[triangle[2]]);
        EXPECT_LT(area.dot(mesh.vertices[triangle[0]] - center), -1e-4);
    }
    for (const auto& [edge, count] : edges) {
        EXPECT_EQ(count, 1);
        EXPECT_TRUE(edges.contains({edge.second, edge.first}));
    }
}

}  // namespace
}  // namespace apps
