// SPDX-License-Identifier: MIT
#include "renderer/scene/scene_file.h"

#include "renderer/core/settings/settings_json.h"
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

// One triangle, and a camera of 0.5 rad at (1, 2, 3) that looks along -z.
const std::string kTriangleAndCamera = R"({"asset": {"version": "2.0"},
    "nodes": [{"mesh": 0}, {"name": "eye", "camera": 0, "translation": [1, 2, 3]}],
    "cameras": [{"name": "lens", "type": "perspective", "perspective": {"yfov": 0.5, "znear": 0.1}}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                   "min": [0, 0, 0], "max": [1, 1, 0]}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}],
    "buffers": [{"byteLength": 36, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";

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
                                "rounds": null, "neighbours": 3, "confidence_cap": 20,
                                "shrink_fraction": 0 } },
        "ground_truth": { "depth_resolution": [256, 256] } })");
    EXPECT_EQ(core::write_value(scene.render), core::write_value(renderer::RenderSettings{}));
}

TEST(SceneFile, GridPointsAreCellCentresXFirst) {
    const auto scene = read_text(
        R"({"geometry": "a.glb", "relay_wall": {"size_m": [2, 1]}, "scan": {"sensing_points": [4, 2]}})");
    const core::WallScan scan = renderer::make_scan(scene).wall();
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

TEST(SceneFile, PatternsPairPointsAsDescribed) {
    auto scene = read_text(R"({"geometry": "a.glb", "scan": {"pattern": "exhaustive",
        "sensing_points": [3, 2], "illumination_points": [2, 2]}})");
    core::WallScan scan = renderer::make_scan(scene).wall();
    EXPECT_EQ(scan.num_pairs(), 24U);
    EXPECT_EQ(scan.illumination_index(13), 2U);
    EXPECT_EQ(scan.sensing_index(13), 1U);
    scene = read_text(R"({"geometry": "a.glb", "scan": {"pattern": "single",
        "illumination_m": [0.1, 0.2, 0], "sensing_points": [3, 2]}})");
    scan = renderer::make_scan(scene).wall();
    EXPECT_EQ(scan.num_pairs(), 6U);
    EXPECT_EQ(scan.illumination.positions[scan.illumination_index(5)], Vec3(0.1, 0.2, 0));
}

TEST(SceneFile, ExplicitPointsReplaceTheGridAndNormalsAreNormalised) {
    const auto scene = read_text(R"({"geometry": "a.glb", "scan": {
        "sensing_points_m": [[0, 0, 0], [1, 0, 0.5]], "sensing_normals": [[0, 0, 2], [0, 1, 1]]}})");
    const core::WallScan scan = renderer::make_scan(scene).wall();
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

TEST(SceneFile, BinsInPicosecondsLeaveTheRestToTheLight) {
    const double width_m = 10e-12 * core::kSpeedOfLight;
    for (const std::string axis : {R"({"opl_start_m": 1.0, "bin_width_m": 0.1, "num_bins": 9})",
                                   R"("auto")",
                                   R"({"num_bins": 100})"}) {
        const auto scene = read_text(R"({"geometry": "a.glb", "time_axis": )" + axis + "}",
                                     {"time_axis.bin_width_ps=10"});
        EXPECT_TRUE(scene.time_axis.automatic) << axis;
        EXPECT_NEAR(scene.time_axis.bin_width_m, width_m, 1e-15);
        EXPECT_TRUE(scene.time_axis.stated.bin_width);
        EXPECT_FALSE(scene.time_axis.stated.opl_start || scene.time_axis.stated.num_bins);
        // What is echoed says the same.
        renderer::SceneTimeAxis again;
        read_value(core::write_value(scene)["time_axis"], "time_axis", again);
        EXPECT_NEAR(again.bin_width_m, width_m, 1e-15);
        EXPECT_TRUE(again.automatic);
    }
    // In any order.
    const auto whole = read_text(
        R"({"geometry": "a.glb"})",
        {"time_axis.num_bins=7", "time_axis.opl_start_ps=100", "time_axis.bin_width_ps=10"});
    EXPECT_FALSE(whole.time_axis.automatic);
    EXPECT_EQ(whole.time_axis.num_bins, 7);
    EXPECT_NEAR(whole.time_axis.opl_start_m, 10.0 * width_m, 1e-14);
    const auto metres =
        read_text(R"({"geometry": "a.glb", "time_axis": "auto"})", {"time_axis.bin_width_m=0.003"});
    EXPECT_TRUE(metres.time_axis.automatic && metres.time_axis.stated.bin_width);
}

TEST(SceneFile, PicosecondsBesideMetresAreRefused) {
    EXPECT_ERROR_WITH(
        read_text(R"({"geometry": "a.glb", "time_axis": {"bin_width_m": 0.1, "bin_width_ps": 3}})"),
        "time_axis.bin_width_ps: found together with bin_width_m");
    EXPECT_ERROR_WITH(
        read_text(R"({"geometry": "a.glb", "time_axis": {"opl_start_m": 1, "opl_start_ps": 3}})"),
        "opl_start_ps");
    EXPECT_ERROR_WITH(read_text(R"({"geometry": "a.glb"})",
                                {"time_axis.bin_width_ps=10", "time_axis.bin_width_m=0.1"}),
                      "--set time_axis.bin_width_ps");
    EXPECT_ERROR_WITH(read_text(R"({"geometry": "a.glb"})", {"time_axis.bin_width_ps=-1"}),
                      "time_axis.bin_width");
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

TEST(SceneFile, CameraTakesThePlaceOfTheScan) {
    const auto scene = read_text(R"({"geometry": "a.glb", "camera": { "position_m": [0, 1, -2],
        "look_at_m": [0, 0, 1], "up": [0, 1, 0], "fov_y_deg": 50, "resolution": [20, 10],
        "light_spot_m": [0.5, 0, 1] }})");
    const core::Scan made = renderer::make_scan(scene);
    EXPECT_EQ(made.name(), "camera");
    EXPECT_FALSE(made.has_wall());
    EXPECT_EQ(made.num_pairs(), 200U);
    EXPECT_EQ(made.devices().detector, Vec3(0, 1, -2));
    EXPECT_EQ(made.devices().laser, Vec3(0.5, 0, 1));
    ASSERT_NE(made.as<core::ImageScan>(), nullptr);
    EXPECT_EQ(made.as<core::ImageScan>()->camera.fov_y_deg, 50.0);
}

TEST(SceneFile, CameraLightIsAtTheCameraUnlessSet) {
    const auto scene = read_text(
        R"({"geometry": "a.glb", "camera": { "position_m": [0, 1, -2], "look_at_m": [0, 0, 1] }})");
    EXPECT_EQ(scene.camera->light_position(), Vec3(0, 1, -2));
}

TEST(SceneFile, CameraMayBeNamedInTheGeometryFile) {
    const test_support::TemporaryFolder folder;
    test_support::write_file_bytes(folder.file("a.gltf"), kTriangleAndCamera);
    test_support::write_file_bytes(folder.file("scene.json"),
                                   R"({"geometry": "a.gltf", "camera": "eye"})");
    const auto scene =
        renderer::read_scene_description(folder.file("scene.json"), {"camera.resolution=[5, 4]"});
    EXPECT_LT((scene.camera->position_m - Vec3(1, 2, 3)).norm(), 1e-12);
    EXPECT_LT((scene.camera->look_at_m - Vec3(1, 2, 2)).norm(), 1e-12);
    EXPECT_NEAR(scene.camera->fov_y_deg, 0.5 * 180.0 / core::kPi, 1e-9);
    EXPECT_EQ(renderer::make_scan(scene).num_pairs(), 20U);
    const auto by_lens =
        renderer::read_scene_description(folder.file("scene.json"), {"camera=lens"});
    EXPECT_EQ(by_lens.camera->position_m, scene.camera->position_m);
    EXPECT_ERROR_WITH(renderer::read_scene_description(folder.file("scene.json"), {"camera=nose"}),
                      "camera: found \"nose\"; must be one of eye");
}

TEST(SceneFile, BadCamerasAreNamed) {
    const auto read_camera = [](const std::string& fields) {
        return read_text(R"({"geometry": "a.glb", "camera": {"position_m": [0, 0, 1], )" + fields +
                         "}}");
    };
    EXPECT_ERROR_WITH(read_camera(R"("look_at_m": [0, 0, 1])"), "camera.look_at_m");
    EXPECT_ERROR_WITH(read_camera(R"("up": [0, 0, 2])"), "camera.up");
    EXPECT_ERROR_WITH(read_camera(R"("up": [0, 0, 0])"), "camera.up");
    EXPECT_ERROR_WITH(read_camera(R"("fov_y_deg": 180)"), "camera.fov_y_deg: found 180");
    EXPECT_ERROR_WITH(read_camera(R"("fov_y_deg": 0)"), "camera.fov_y_deg");
    EXPECT_ERROR_WITH(read_camera(R"("resolution": [4, 0])"), "camera.resolution: found 0");
    EXPECT_ERROR_WITH(read_camera(R"("resolution": [400000, 400000])"), "camera.resolution");
    EXPECT_ERROR_WITH(read_camera(R"("light_m": [0, 0, 0], "light_spot_m": [0, 0, 0])"),
                      "camera.light_spot_m");
    EXPECT_ERROR_WITH(read_camera(R"("lens": 1)"), "camera.lens");
    EXPECT_ERROR_WITH(read_text(R"({"geometry": "a.glb", "camera": 3})"), "camera");
    EXPECT_ERROR_WITH(read_text(R"({"geometry": "a.glb", "scan": {}, "camera": "eye"})"),
                      "camera: found together with scan");
    EXPECT_ERROR_WITH(
        read_text(R"({"geometry": "a.glb", "relay_wall": {}})", {"camera.position_m=[0, 0, 1]"}),
        "camera: found together with relay_wall");
    EXPECT_ERROR_WITH(read_text(R"({"geometry": "a.glb", "camera": {"position_m": [0, 0, 1],
                      "light_spot_m": [0, 0, 0]}, "render": {"max_bounces": 1}})"),
                      "render.max_bounces: found 1 with camera.light_spot_m");
}

TEST(SceneFile, FramesAreReadAndChecked) {
    const auto scene = read_text(
        R"({"geometry": "a.glb", "frames": {"count": 100, "gate_step_m": 0.02, "frame_s": 0.04}})");
    ASSERT_TRUE(scene.frames.has_value());
    EXPECT_EQ(scene.frames->count, 100);
    EXPECT_EQ(scene.frames->gate_step_m, 0.02);
    EXPECT_EQ(scene.frames->frame_s, 0.04);
    EXPECT_FALSE(read_text(R"({"geometry": "a.glb"})").frames.has_value());
    EXPECT_ERROR_WITH(read_text(R"({"geometry": "a.glb", "frames": {"count": 0}})"),
                      "frames.count: found 0");
    EXPECT_ERROR_WITH(read_text(R"({"geometry": "a.glb", "frames": {"frame_s": -1}})"),
                      "frames.frame_s");
    EXPECT_ERROR_WITH(read_text(R"({"geometry": "a.glb", "frames": {"count": 2000000000}})"),
                      "must fit into");
}

TEST(SceneFile, VelocityAxisIsReadAndChecked) {
    const auto scene = read_text(R"({"geometry": "a.glb", "velocity_axis": {
        "start_m_per_s": -10, "bin_width_m_per_s": 0.5, "num_bins": 40, "with_time": false }})");
    ASSERT_TRUE(scene.velocity_axis.has_value());
    EXPECT_EQ(core::write_value(*scene.velocity_axis), core::write_value(core::VelocityAxis{}));
    EXPECT_FALSE(read_text(R"({"geometry": "a.glb"})").velocity_axis.has_value());
    const auto expect_error = [](const std::string& axis, const std::string& part) {
        EXPECT_ERROR_WITH(read_text(R"({"geometry": "a.glb", "velocity_axis": {)" + axis + "}}"),
                          part);
    };
    expect_error(R"("num_bins": 0)", "velocity_axis.num_bins: found 0");
    expect_error(R"("bin_width_m_per_s": 0)", "velocity_axis.bin_width_m_per_s: found 0");
    expect_error(R"("carrier_hz": -1)", "velocity_axis.carrier_hz: found -1");
    expect_error(R"("bins": 4)", "carrier_hz");
    expect_error(R"("num_bins": 1000000000)", "must fit into");
    expect_error(R"("num_bins": 1000000000, "with_time": true)", "values per pair");
}

}  // namespace
