// SPDX-License-Identifier: MIT
#include "renderer/scene/scene_checks.h"

#include "tests/support/error_message.h"
#include "tests/support/test_scenes.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <utility>
#include <vector>

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
        EXPECT_ERROR_WITH(make(panel_at(depth_m), kScan),
                          "in front of the wall point (0.1, 0.1, 0)");
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
    EXPECT_NO_THROW(make(objects, test_support::confocal_scan({{0.1, 0.09995, 0}})));
    EXPECT_NO_THROW(make(objects, test_support::confocal_scan({{0.1, 0.11, 0}})));
}

TEST(SceneChecks, WhatLiesOffTheRectangleOrBehindItIsNamed) {
    const auto warnings = [](const std::vector<Object>& objects, const core::WallScan& scan) {
        return make(objects, scan).warnings();
    };
    std::vector<Object> objects = panel_at(0.5);
    EXPECT_TRUE(warnings(objects, kScan).empty());
    const auto single = [](const Vec3& spot) {
        return test_support::single_scan(spot, {Vec3(0.1, 0.1, 0)});
    };
    for (const auto& [spot, words] :
         std::vector<std::pair<Vec3, std::string>>{{{0.2, 0.1, -0.1}, "0.1 m behind"},
                                                   {{0.2, 0.1, 0.2}, "0.2 m in front of"},
                                                   {{0.8, 0.1, 0}, "0.3 m beside"}}) {
        const auto found = warnings(objects, single(spot));
        ASSERT_EQ(found.size(), 1U) << words;
        EXPECT_NE(found[0].find(words + " the relay wall"), std::string::npos) << found[0];
        EXPECT_NE(found[0].find("scan.illumination_m"), std::string::npos) << found[0];
    }
    objects[0].mesh.vertices[0].z() = -0.3;
    const auto behind = warnings(objects, kScan);
    ASSERT_EQ(behind.size(), 1U);
    EXPECT_NE(behind[0].find("0.3 m behind the relay wall to 0.5 m"), std::string::npos);
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
