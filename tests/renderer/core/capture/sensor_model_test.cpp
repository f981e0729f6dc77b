// SPDX-License-Identifier: MIT
#include "renderer/core/capture/sensor_model.h"

#include "renderer/core/settings/settings_json.h"
#include "tests/support/error_message.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <string>

namespace {

core::Json json_of(const std::string& name) {
    return core::write_value(core::read_sensor_model(name));
}

// The model read from a file that differs from a shipped one in what is given.
core::SensorModel shipped_model_with(const core::Json& changes) {
    const test_support::TemporaryFolder folder;
    core::Json json = json_of("vl53l8");
    json.merge_patch(changes);
    const std::string path = folder.file("other.json");
    test_support::write_file_bytes(path, json.dump());
    return core::read_sensor_model(path);
}

TEST(SensorModel, EveryNumberOfTheShippedSensorsHasASource) {
    const std::vector<std::string> names = core::shipped_sensors();
    EXPECT_EQ(names.size(), 3U);
    for (const std::string& name : names) {
        const core::SensorModel model = core::read_sensor_model(name);
        EXPECT_EQ(model.name, name);
        const core::Json json = core::write_value(model);
        std::vector<std::string> keys;
        for (const auto& [key, value] : json.items()) {
            if (key != "name" && key != "title" && key != "sources" && key != "detector") {
                keys.push_back(key);
            }
        }
        for (const auto& [key, value] : json["detector"].items()) keys.push_back("detector." + key);
        for (const std::string& key : keys) {
            EXPECT_TRUE(model.sources.count(key) == 1 && model.sources.at(key).size() > 10)
                << name << " " << key;
        }
        EXPECT_EQ(model.sources.size(), keys.size()) << name;
    }
}

TEST(SensorModel, BinsAreThoseOfPathLength) {
    const core::TimeAxis axis = core::read_sensor_model("tmf8828").time_axis();
    EXPECT_EQ(axis.num_bins, 128);
    EXPECT_NEAR(axis.bin_width_m, 0.02638, 1e-5);
    EXPECT_NEAR(axis.bin_center_m(13), 0.0, 1e-9);
}

TEST(SensorModel, FilesAreReadAndWrittenUnchanged) {
    const core::SensorModel model = shipped_model_with({{"zones", {8, 8}}, {"name", "mine"}});
    EXPECT_EQ(model.num_zones(), 64);
    EXPECT_EQ(model.name, "mine");
    core::Json before = json_of("vl53l8");
    before.merge_patch({{"zones", {8, 8}}, {"name", "mine"}});
    EXPECT_EQ(core::write_value(model), before);
}

TEST(SensorModel, MessagesNameFileKeyAndRange) {
    EXPECT_ERROR_WITH(core::read_sensor_model("vl53l9", "scan.sensor"),
                      "scan.sensor: found \"vl53l9\"; did you mean 'vl53l8'? must be one of "
                      "vl53l8, tmf8828, tmf8829 or a");
    EXPECT_ERROR_WITH(core::read_sensor_model("nowhere.json"), "nowhere.json");
    EXPECT_ERROR_WITH(shipped_model_with({{"zones", {0, 4}}}), "other.json: zones");
    EXPECT_ERROR_WITH(shipped_model_with({{"zones", {128, 128}}}), "16384 zones");
    EXPECT_ERROR_WITH(shipped_model_with({{"fov_deg", {45, 180}}}), "fov_deg");
    EXPECT_ERROR_WITH(shipped_model_with({{"illumination", "scanned"}}), "flood|zones");
    EXPECT_ERROR_WITH(shipped_model_with({{"detector", {{"efficiency", 1.5}}}}),
                      "detector.efficiency");
    EXPECT_ERROR_WITH(shipped_model_with({{"detector", {{"zone_crosstalk", 0.3}}}}),
                      "zone_crosstalk");
    EXPECT_ERROR_WITH(shipped_model_with({{"bin_width_ps", 250}}), "bin_width_ps");
    EXPECT_ERROR_WITH(shipped_model_with({{"sources", {{"zones", 3}}}}), "sources.zones");
}

}  // namespace
