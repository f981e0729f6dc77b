// SPDX-License-Identifier: MIT
// Scans of the pattern sensor in scene.json.
#include "renderer/core/settings/settings_json.h"
#include "renderer/scene/scene_file.h"
#include "tests/support/error_message.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

namespace {

const core::Json kSensorPose = {
    {"position_m", {0.1, 0.0, 1.0}}, {"forward", {0, 0, -1}}, {"up", {0, 1, 0}}};

core::Json sensor_scene_with(const core::Json& scan_changes) {
    core::Json scene = {
        {"geometry", "scene.glb"},
        {"scan", {{"pattern", "sensor"}, {"sensor", "vl53l8"}, {"pose", kSensorPose}}}};
    scene["scan"].merge_patch(scan_changes);
    return scene;
}

renderer::SceneDescription read_sensor_scene(const core::Json& json,
                                             const std::vector<std::string>& overrides = {},
                                             const core::Json& sensor_file = nullptr) {
    const test_support::TemporaryFolder folder;
    test_support::write_file_bytes(folder.file("scene.json"), json.dump());
    if (!sensor_file.is_null()) {
        test_support::write_file_bytes(folder.file("mine.json"), sensor_file.dump());
    }
    return renderer::read_scene_description(folder.file("scene.json"), overrides);
}

TEST(SensorSettings, ScanIsThatOfTheZones) {
    const auto scene = read_sensor_scene(sensor_scene_with({{"subsamples", 2}}));
    const core::Scan made = renderer::make_scan(scene);
    ASSERT_NE(made.as<core::SensorScan>(), nullptr);
    const core::SensorScan& scan = *made.as<core::SensorScan>();
    EXPECT_EQ(scan.num_pairs(), 16U);
    EXPECT_EQ(scan.pattern, core::ScanPattern::Confocal);
    EXPECT_EQ(scan.setup->subsamples, 2);
    EXPECT_EQ(scan.detector_position, core::Vec3(0.1, 0.0, 1.0));
    EXPECT_NEAR(scan.laser_position.x(), 0.104, 1e-12);
    EXPECT_EQ(scan.opl_origin, core::OplOrigin::Device);
}

TEST(SensorSettings, BinsAreTheSensorsUnlessGiven) {
    core::Json json = sensor_scene_with(core::Json::object());
    EXPECT_EQ(read_sensor_scene(json).time_axis.num_bins, 128);
    EXPECT_NEAR(read_sensor_scene(json).time_axis.bin_width_m, 0.0749, 1e-4);
    json["time_axis"] = "auto";
    EXPECT_EQ(read_sensor_scene(json).time_axis.num_bins, 128);
    json["time_axis"] = {{"bin_width_m", 0.01}, {"num_bins", 400}};
    EXPECT_EQ(read_sensor_scene(json).time_axis.num_bins, 400);
}

TEST(SensorSettings, SensorsComeByNameFromFilesOrInPlace) {
    core::Json model = core::write_value(core::read_sensor_model("tmf8828"));
    model["zones"] = {5, 4};
    EXPECT_EQ(read_sensor_scene(sensor_scene_with({{"sensor", "mine.json"}}), {}, model)
                  .scan.sensor->num_zones(),
              20);
    EXPECT_EQ(read_sensor_scene(sensor_scene_with({{"sensor", model}})).scan.sensor->num_zones(),
              20);
    const auto changed =
        read_sensor_scene(sensor_scene_with(core::Json::object()), {"scan.sensor.zones=[8,8]"});
    EXPECT_EQ(changed.scan.sensor->num_zones(), 64);
    EXPECT_EQ(changed.scan.sensor->num_bins, 128);
    const auto replaced =
        read_sensor_scene(sensor_scene_with(core::Json::object()), {"scan.sensor=tmf8829"});
    EXPECT_EQ(replaced.scan.sensor->name, "tmf8829");
    EXPECT_EQ(replaced.time_axis.num_bins, 64);
}

TEST(SensorSettings, EchoReadsBack) {
    const auto scene = read_sensor_scene(sensor_scene_with({{"sensor", {{"num_bins", 7}}}}));
    renderer::SceneDescription again;
    core::read_value(core::write_value(scene), "echo", again);
    EXPECT_EQ(core::write_value(again), core::write_value(scene));
    EXPECT_TRUE(again.scan.pattern.of_sensor);
}

TEST(SensorSettings, MessagesNameFileAndKey) {
    const auto bad = [](const core::Json& changes) {
        return read_sensor_scene(sensor_scene_with(changes));
    };
    EXPECT_ERROR_WITH(bad({{"sensor", "vl53"}}), "scene.json: scan.sensor: found \"vl53\"");
    EXPECT_ERROR_WITH(bad({{"sensor", "no.json"}}), "no.json");
    EXPECT_ERROR_WITH(bad({{"sensor", nullptr}}), "scan.sensor: found none");
    EXPECT_ERROR_WITH(bad({{"sensor", {{"zones", {0, 1}}}}}), "scan.sensor.zones");
    EXPECT_ERROR_WITH(bad({{"pose", nullptr}}), "neither pose nor poses");
    EXPECT_ERROR_WITH(bad({{"poses", {kSensorPose}}}), "it together with poses");
    EXPECT_ERROR_WITH(bad({{"pose", nullptr}, {"poses", {kSensorPose, kSensorPose}}}),
                      "frames.count, 1");
    EXPECT_ERROR_WITH(bad({{"pose", {{"forward", {0, 0, 0}}}}}), "scan.pose.forward");
    EXPECT_ERROR_WITH(bad({{"subsamples", 0}}), "scan.subsamples");
    EXPECT_ERROR_WITH(bad({{"pattern", "confocal"}}), "left out, or pattern be sensor");
    EXPECT_ERROR_WITH(bad({{"pattern", "sensors"}}), "single|confocal|exhaustive|sensor");
    EXPECT_ERROR_WITH(renderer::make_scan(bad({{"pose", {{"forward", {0, 0, 1}}}}})),
                      "no zone sees the relay wall");
}

}  // namespace
