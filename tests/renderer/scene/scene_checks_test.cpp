// SPDX-License-Identifier: MIT
#include "renderer/scene/scene_checks.h"

#include "tests/support/error_message.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <limits>

namespace {

using core::Vec3;
using renderer::Object;

/// A panel at a depth before the wall of 1 m, and one 1 m away.
std::vector<Object> panel_at(double depth_m) {
    std::vector<Object> objects{
        test_support::parallelogram_object({{-0.2, -0.1, depth_m}, {0.4, 0, 0}, {0, 0.3, 0}}),
        test_support::parallelogram_object({{-0.2, -0.1, 1}, {0.4, 0, 0}, {0, 0.3, 0}})};
    objects[0].name = "panel";
    return objects;
}

renderer::Scene make(std::vector<Object> objects, const core::WallScan& scan) {
    return renderer::make_scene({std::move(objects), {}}, {}, scan);
}

const core::WallScan kScan = test_support::confocal_scan({{0.1, 0.1, 0}, {0.4, 0.4, 0}});

TEST(SceneChecks, SurfacesTooNearToAWallPointAreRefused) {
    for (const double depth_m : {1e-6, 1e-5, 9e-5}) {
        EXPECT_ERROR_WITH(make(panel_at(depth_m), kScan), "object panel: found");
        EXPECT_ERROR_WITH(make(panel_at(depth_m), kScan), "in front of the wall point (0.1 0.1 0)");
    }
    EXPECT_NO_THROW(make(panel_at(2e-4), kScan));
    EXPECT_NO_THROW(make(panel_at(1e-2), kScan));
}

TEST(SceneChecks, SpotsOfTheLaserCountToo) {
    const Vec3 aside(0.4, 0.4, 0);
    EXPECT_ERROR_WITH(make(panel_at(1e-5), test_support::single_scan({0.1, 0.1, 0}, {aside})),
                      "object panel: found");
    EXPECT_NO_THROW(make(panel_at(1e-5), test_support::single_scan(aside, {aside})));
}

TEST(SceneChecks, SurfacesOnTheWallOrBehindItMayStay) {
    EXPECT_NO_THROW(make(panel_at(-1e-6), kScan));
    const renderer::Scene scene = make(panel_at(0.0), kScan);
    ASSERT_EQ(scene.coincident_faces().size(), 1U);
    EXPECT_EQ(scene.coincident_faces()[0].by, "relay_wall");
    std::vector<Object> alone = panel_at(1e-7);
    alone.pop_back();
    EXPECT_ERROR_WITH(make(alone, kScan), "found all its surfaces on the relay wall");
}

TEST(SceneChecks, EdgesThatTouchTheWallMayStay) {
    std::vector<Object> objects = panel_at(0.5);
    objects.push_back(  // a floor that begins at the wall, below its points
        test_support::parallelogram_object({{-0.5, 0.0999, 0}, {1, 0, 0}, {0, 0, 1}}));
    EXPECT_ERROR_WITH(make(objects, test_support::confocal_scan({{0.1, 0.09995, 0}})), "found");
    EXPECT_NO_THROW(make(objects, test_support::confocal_scan({{0.1, 0.11, 0}})));
}

TEST(SceneChecks, VerticesThatAreNotFiniteAreRefused) {
    for (const double value :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        std::vector<Object> objects = panel_at(0.5);
        objects[0].mesh.vertices[1].y() = value;
        EXPECT_ERROR_WITH(make(objects, kScan), "object panel: has a vertex that is not finite");
    }
}

}  // namespace
