// SPDX-License-Identifier: MIT
#include "renderer/scene_file.h"

#include "tests/support/error_message.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

namespace {

using core::Vec3;

renderer::SceneDescription read_text(const std::string& json,
                                     const std::vector<std::string>& overrides = {}) {
    const test_support::TemporaryFolder folder;
    test_support::write_file_bytes(folder.file("scene.json"), json);
    return renderer::read_scene_description(folder.file("scene.json"), overrides);
}

TEST(SceneFile, DefaultsAreThoseOfTheFormat) {
    const auto scene = read_text(R"({"geometry": "a.glb"})");
    EXPECT_EQ(scene.relay_wall.size_m, (std::array<double, 2>{1.0, 1.0}));
    EXPECT_EQ(scene.scan.pattern, core::ScanPattern::Confocal);
    EXPECT_EQ(scene.time_axis.num_bins, 512);
    EXPECT_EQ(scene.render.max_bounces, 3);
    EXPECT_EQ(scene.ground_truth.depth_resolution, (std::array<int, 2>{256, 256}));
}

// Every key of the format, as a user would copy them from its description.
TEST(SceneFile, AllKeysOfTheFormatAreRead) {
    const auto scene = read_text(R"({
        "geometry": "scene.glb",
        "relay_wall": { "center_m": [0,0,0], "normal": [0,0,1], "up": [0,1,0], "size_m": [1,1],
                        "albedo": 1.0 },
        "scan": { "pattern": "confocal", "sensing_points": [64, 64], "illumination_m": [0,0,0],
                  "illumination_points": [16, 16], "opl_origin": "relay_wall",
                  "laser_m": [-0.5,0,0.25], "detector_m": [-0.5,0,0.25] },
        "time_axis": { "opl_start_m": 0.0, "bin_width_m": 0.008, "num_bins": 512 },
        "render": { "method": "auto", "max_bounces": 3, "samples": 256, "seed": 0,
                    "exclude": "mis", "exclude_area_above_m2": null, "gate": "box",
                    "by_order": false, "direct_return": false,
                    "restir": { "reuse": "path_length", "chart": "adaptive", "gauge": "average",
                                "rounds": 1, "neighbours": 3, "confidence_cap": 20,
                                "shrink_fraction": 0 } },
        "ground_truth": { "depth_resolution": [256, 256] } })");
    EXPECT_EQ(core::write_value(scene.render), core::write_value(renderer::RenderSettings{}));
}

TEST(SceneFile, GridPointsAreCellCentresXFirst) {
    const auto scene = read_text(
        R"({"geometry": "a.glb", "relay_wall": {"size_m": [2, 1]}, "scan": {"sensing_points": [4, 2]}})");
    const core::Scan scan = renderer::make_scan(scene);
    ASSERT_EQ(scan.sensing.size(), 8U);
    EXPECT_LT((scan.sensing.positions[0] - Vec3(-0.75, -0.25, 0)).norm(), 1e-12);
    EXPECT_LT((scan.sensing.positions[1] - Vec3(-0.75, 0.25, 0)).norm(), 1e-12);
    EXPECT_LT((scan.sensing.positions[2] - Vec3(-0.25, -0.25, 0)).norm(), 1e-12);
    EXPECT_EQ(scan.illumination.positions, scan.sensing.positions);
}

TEST(SceneFile, WallFrameHasXAlongUpCrossNormal) {
    renderer::RelayWall wall;
    wall.normal = Vec3(0, 0, -2);
    wall.up = Vec3(0, 3, 1);
    const core::Transform frame = wall.world_from_wall();
    EXPECT_LT((frame.linear().col(0) - Vec3(-1, 0, 0)).norm(), 1e-12);
    EXPECT_LT((frame.linear().col(1) - Vec3(0, 1, 0)).norm(), 1e-12);
    EXPECT_LT((frame.linear().col(2) - Vec3(0, 0, -1)).norm(), 1e-12);
    EXPECT_NEAR(frame.linear().determinant(), 1.0, 1e-12);
}

TEST(SceneFile, PatternsPairPointsAsStated) {
    auto scene = read_text(R"({"geometry": "a.glb", "scan": {"pattern": "exhaustive",
        "sensing_points": [3, 2], "illumination_points": [2, 2]}})");
    core::Scan scan = renderer::make_scan(scene);
    EXPECT_EQ(scan.num_pairs(), 24U);
    EXPECT_EQ(scan.illumination_index(13), 2U);
    EXPECT_EQ(scan.sensing_index(13), 1U);
    scene = read_text(R"({"geometry": "a.glb", "scan": {"pattern": "single",
        "illumination_m": [0.1, 0.2, 0], "sensing_points": [3, 2]}})");
    scan = renderer::make_scan(scene);
    EXPECT_EQ(scan.num_pairs(), 6U);
    EXPECT_EQ(scan.illumination.positions[scan.illumination_index(5)], Vec3(0.1, 0.2, 0));
}

TEST(SceneFile, ExplicitPointsReplaceTheGridAndNormalsAreNormalised) {
    const auto scene = read_text(R"({"geometry": "a.glb", "scan": {
        "sensing_points_m": [[0, 0, 0], [1, 0, 0.5]], "sensing_normals": [[0, 0, 2], [0, 1, 1]]}})");
    const core::Scan scan = renderer::make_scan(scene);
    ASSERT_EQ(scan.sensing.size(), 2U);
    EXPECT_FALSE(scan.sensing.grid);
    EXPECT_NEAR(scan.sensing.normals[1].norm(), 1.0, 1e-12);
    EXPECT_FALSE(renderer::rectangle_carries_scan(scene.relay_wall, scan));
}

TEST(SceneFile, OverridesWinOverTheFile) {
    const auto scene = read_text(R"({"geometry": "a.glb", "time_axis": {"num_bins": 100}})",
                                 {"time_axis.num_bins=7", "scan.pattern=single"});
    EXPECT_EQ(scene.time_axis.num_bins, 7);
    EXPECT_EQ(scene.scan.pattern, core::ScanPattern::Single);
}

TEST(SceneFile, WhatIsOutOfRangeIsNamed) {
    const auto expect_error = [](const std::string& rest, const std::string& part) {
        EXPECT_ERROR_WITH(read_text(R"({"geometry": "a.glb", )" + rest + "}"), part);
    };
    expect_error(R"("relay_wall": {"normal": [0, 0, 0]})", "relay_wall.normal length");
    expect_error(R"("relay_wall": {"up": [0, 0, 3]})", "relay_wall.up");
    expect_error(R"("relay_wall": {"size_m": [1, 0]})", "relay_wall.size_m");
    expect_error(R"("relay_wall": {"albedo": 1.5})", "relay_wall.albedo");
    expect_error(R"("scan": {"sensing_points": [0, 3]})", "scan.sensing_points");
    expect_error(R"("scan": {"sensing_points": [40000, 40000]})", "memory");
    expect_error(R"("render": {"max_bounces": 0})", "render.max_bounces");
    expect_error(R"("render": {"gate": "tent"})", "render.gate");
    expect_error(R"("time_axis": {"num_bins": 2000000000})", "memory");
    EXPECT_ERROR_WITH(read_text("{}"), "geometry");
}

}  // namespace
