// SPDX-License-Identifier: MIT
#include "renderer/scene/ground_truth.h"

#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

namespace {

using core::Vec3;

renderer::SceneDescription description_with(const Vec3& center,
                                            const Vec3& normal,
                                            const Vec3& up) {
    renderer::SceneDescription description;
    description.relay_wall.center_m = center;
    description.relay_wall.normal = normal;
    description.relay_wall.up = up;
    description.ground_truth.depth_resolution = {40, 20};
    return description;
}

TEST(GroundTruth, TiltedPlaneHasItsDepthNormalAndAlbedo) {
    const auto description = description_with(Vec3::Zero(), Vec3::UnitZ(), Vec3::UnitY());
    renderer::SceneGeometry geometry;
    // z = 0.8 + 0.5 x over the left half of the wall.
    geometry.objects.push_back(test_support::parallelogram_object(
        {Vec3(-0.5, -0.5, 0.55), Vec3(0.5, 0, 0.25), Vec3(0, 1, 0), 0.3}));
    const core::Scan scan = renderer::make_scan(description);
    const renderer::Scene scene(std::move(geometry), scan, description.relay_wall);
    const core::DepthMap map = renderer::trace_ground_truth(scene, description);
    const Vec3 normal = Vec3(0.5, 0, -1).normalized();
    for (std::size_t ix = 0; ix < 40; ++ix) {
        for (std::size_t iy = 0; iy < 20; ++iy) {
            const std::size_t i = map.index(ix, iy);
            EXPECT_EQ(map.is_foreground(i), map.x_m[ix] < 0.0);
            if (!map.is_foreground(i)) continue;
            EXPECT_NEAR(map.depth_m[i], 0.8 + 0.5 * map.x_m[ix], 1e-9);
            EXPECT_NEAR(map.normals[i].dot(normal), 1.0, 1e-9);
            EXPECT_EQ(map.albedo[i], 0.3);
        }
    }
    EXPECT_EQ(surface_points(map).positions.size(), 400U);
}

TEST(GroundTruth, FollowsThePoseOfTheWall) {
    // A wall at x = 2 that looks along -x, with a plate 0.6 m in front of its upper part.
    const auto description = description_with(Vec3(2, 0, 5), Vec3(-1, 0, 0), Vec3::UnitY());
    renderer::SceneGeometry geometry;
    geometry.objects.push_back(
        test_support::parallelogram_object({Vec3(1.4, 0.0, 4.0), Vec3(0, 1, 0), Vec3(0, 0, 2)}));
    const core::Scan scan = renderer::make_scan(description);
    const renderer::Scene scene(std::move(geometry), scan, description.relay_wall);
    const core::DepthMap map = renderer::trace_ground_truth(scene, description);
    for (std::size_t ix = 0; ix < 40; ++ix) {
        for (std::size_t iy = 0; iy < 20; ++iy) {
            const std::size_t i = map.index(ix, iy);
            EXPECT_EQ(map.is_foreground(i), map.y_m[iy] > 0.0);
            if (!map.is_foreground(i)) continue;
            EXPECT_NEAR(map.depth_m[i], 0.6, 1e-9);
            EXPECT_NEAR(map.point_world(ix, iy).x(), 1.4, 1e-9);
        }
    }
}

// A bar 40 mm high, 0.8 m before the wall, between the centres of columns 0.1 m wide.
TEST(GroundTruth, SeesWhatFallsBetweenColumns) {
    const auto description = description_with(Vec3::Zero(), Vec3::UnitZ(), Vec3::UnitY());
    renderer::SceneGeometry geometry;
    geometry.objects.push_back(test_support::parallelogram_object(
        {Vec3(-0.45, -0.02, 0.8), Vec3(0.9, 0, 0), Vec3(0, 0.04, 0), 0.3}));
    const core::Scan scan = renderer::make_scan(description);
    const renderer::Scene scene(std::move(geometry), scan, description.relay_wall);
    std::vector<double> centres_m;
    for (int i = 0; i < 10; ++i) centres_m.push_back(-0.45 + 0.1 * i);
    const core::Transform wall = description.relay_wall.world_from_wall();
    EXPECT_TRUE(surface_points(renderer::trace_depth_map(scene, wall, centres_m, centres_m))
                    .positions.empty());
    const core::TrueSurface truth =
        renderer::trace_true_surface(scene, wall, centres_m, centres_m, 0.005);
    EXPECT_EQ(truth.per_side, 20U);
    for (const std::size_t ix : {2U, 7U}) {
        for (const std::size_t iy : {4U, 5U}) {
            const auto& column = truth.columns[truth.main.index(ix, iy)];
            ASSERT_EQ(column.size(), 1U);
            EXPECT_NEAR(column[0].depth_m, 0.8, 1e-9);
            EXPECT_NEAR(column[0].fraction, 0.2, 1e-12);
        }
    }
    EXPECT_EQ(truth.covered(truth.main.index(2, 3)), 0.0);
}

// A plate 0.2 m behind a front one of the same shape, of which other points of the wall see all but
// the middle; a box's rear face, which nobody sees.
TEST(GroundTruth, SeesPastWhatHidesASurface) {
    const auto description = description_with(Vec3::Zero(), Vec3::UnitZ(), Vec3::UnitY());
    renderer::SceneGeometry geometry;
    const auto plate = [&](double z) {
        geometry.objects.push_back(test_support::parallelogram_object(
            {Vec3(-0.1, -0.1, z), Vec3(0.2, 0, 0), Vec3(0, 0.2, 0), 0.3}));
    };
    plate(0.8);
    plate(1.0);
    plate(1.0 + 1e-3);
    const core::Scan scan = renderer::make_scan(description);
    const renderer::Scene scene(std::move(geometry), scan, description.relay_wall);
    std::vector<double> centres_m;
    for (int i = 0; i < 20; ++i) centres_m.push_back(-0.95 + 0.1 * i);
    const core::TrueSurface truth = renderer::trace_true_surface(
        scene, description.relay_wall.world_from_wall(), centres_m, centres_m, 0.025);
    const auto& column = truth.columns[truth.main.index(9, 9)];
    ASSERT_EQ(column.size(), 2U);
    EXPECT_NEAR(column[0].depth_m, 0.8, 1e-9);
    EXPECT_DOUBLE_EQ(column[0].fraction, 1.0);
    EXPECT_NEAR(column[1].depth_m, 1.0, 1e-9);
    EXPECT_EQ(column[1].fraction, 0.0) << "not seen along the normal";
    EXPECT_NEAR(truth.main.depth_m[truth.main.index(9, 9)], 0.8, 1e-9);
    EXPECT_DOUBLE_EQ(truth.covered(truth.main.index(9, 9)), 1.0);
}

}  // namespace
