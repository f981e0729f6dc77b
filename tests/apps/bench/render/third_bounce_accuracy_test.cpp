// SPDX-License-Identifier: MIT
// What `nlos bench render --part accuracy` measures, on fewer scenes.
#include "apps/bench/render/third_bounce.h"
#include "apps/shapes/shapes.h"
#include "renderer/core/settings/json_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

namespace apps {
namespace {

TEST(TargetError, IsHonouredOnRandomScenesAndNotFarUndercut) {
    constexpr int kScenes = 6;
    const core::Json errors = bench_target_errors(kScenes, {});
    ASSERT_EQ(errors.size(), 3U * kScenes);
    int missed = 0;
    int far_below = 0;
    for (const core::Json& error : errors) {
        missed += error["met"].get<bool>() ? 0 : 1;
        far_below += error["is_far_below"].get<bool>() ? 1 : 0;
        EXPECT_GT(error["rel_l2"].get<double>(), 0.0);
        EXPECT_LT(error["rel_l2"].get<double>(), 2.0 * error["target_error"].get<double>())
            << error;
    }
    EXPECT_LE(missed, 1);
    EXPECT_LE(far_below, 1);
}

TEST(Agreement, OfIntegratorAndPathsHoldsBinByBin) {
    const core::Json agreements =
        bench_agreement({NLOS_SOURCE_DIR "/scenes/letter/scene.json"}, {});
    ASSERT_EQ(agreements.size(), 3U);
    for (const core::Json& agreement : agreements) {
        EXPECT_GT(agreement["num_bins"].get<int>(), 200) << agreement;
        EXPECT_GT(agreement["p_value"].get<double>(), 1e-3) << agreement;
        EXPECT_GT(agreement["within_95"].get<double>(), 0.93) << agreement;
        EXPECT_NEAR(agreement["energy_ratio"].get<double>(),
                    1.0,
                    4.0 * agreement["energy_sigma"].get<double>())
            << agreement;
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
