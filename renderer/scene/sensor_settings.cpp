// SPDX-License-Identifier: MIT
#include "renderer/scene/sensor_settings.h"

#include "renderer/core/settings/settings_json.h"
#include "renderer/scene/measurement.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

namespace renderer {

using core::Error;
using core::require;

void read_value(const core::Json& json, const std::string& where, ScanPatternSetting& pattern) {
    pattern.of_sensor = json == "sensor";
    if (pattern.of_sensor) {
        pattern.pattern = core::ScanPattern::Confocal;
        return;
    }
    const auto& names = core::EnumNames<core::ScanPattern>::value;
    const bool is_known = json.is_string() && std::ranges::any_of(names, [&](const auto& entry) {
                              return json.get_ref<const std::string&>() == entry.second;
                          });
    if (!is_known) {
        core::throw_wrong_type(
            where, json, "one of " + core::enum_choices<core::ScanPattern>() + "|sensor");
    }
    core::read_value(json, where, pattern.pattern);
}

core::Json write_value(const ScanPatternSetting& pattern) {
    return pattern.of_sensor ? core::Json("sensor") : core::write_value(pattern.pattern);
}

void read_value(const core::Json& json, const std::string& where, SensorSettings& sensor) {
    if (json.is_string()) {
        sensor.source = json.get<std::string>();
    } else {
        core::read_value<SensorSettings>(json, where, sensor);
    }
}

core::Json write_value(const SensorSettings& sensor) {
    return core::write_value(static_cast<const core::SensorModel&>(sensor));
}

void read_sensor(const std::string& folder, const std::string& where, SensorSettings& sensor) {
    if (sensor.source.empty()) return;
    namespace fs = std::filesystem;
    const bool is_file = fs::path(sensor.source).extension() == ".json";
    const std::string source =
        is_file ? (fs::path(folder) / sensor.source).string() : sensor.source;
    sensor = {core::read_sensor_model(source, where), ""};
}

void look_up_sensor(const std::string& folder,
                    const std::string& where,
                    const core::Json& keys,
                    SceneDescription& scene) {
    if (scene.scan.sensor) read_sensor(folder, where + "scan.sensor", *scene.scan.sensor);
    if (!scene.scan.pattern.of_sensor || !scene.scan.sensor) return;
    const bool is_open = scene.time_axis.automatic && !scene.time_axis.stated.bin_width;
    if (is_open || !keys.contains("time_axis")) {
        scene.time_axis = {scene.scan.sensor->time_axis()};
    }
}

namespace {

void validate_zones(const SceneDescription& scene, const std::string& prefix) {
    const ScanSettings& scan = scene.scan;
    const std::string where = prefix + "scan";
    validate_wall(scene, prefix);
    require(scan.sensor.has_value(),
            where + ".sensor",
            "none with pattern sensor",
            fmt::format("one of {}, a .json file or an object",
                        fmt::join(core::shipped_sensors(), ", ")));
    core::validate(static_cast<const core::SensorModel&>(*scan.sensor), where + ".sensor");
    if (!scan.sensing_points_m.empty() || !scan.illumination_points_m.empty()) {
        throw Error(where + ".sensing_points_m",
                    "found points with pattern sensor",
                    "must be left out: the sensor's zones say where it looks");
    }
    require(scan.pose.has_value() != !scan.poses.empty(),
            where + ".pose",
            scan.pose ? "it together with poses" : "neither pose nor poses",
            "one of them");
    if (scan.pose) core::validate(*scan.pose, where + ".pose");
    for (std::size_t i = 0; i < scan.poses.size(); ++i) {
        core::validate(scan.poses[i], fmt::format("{}.poses[{}]", where, i));
    }
    if (scan.poses.empty()) return;
    const std::size_t frames = scene.frames ? static_cast<std::size_t>(scene.frames->count) : 1;
    require(scan.poses.size() == frames,
            where + ".poses",
            fmt::format("{} poses", scan.poses.size()),
            fmt::format("as many as frames.count, {}", frames));
}

core::Scan make_zones(const SceneDescription& scene) {
    core::SensorSetup setup;
    setup.model = *scene.scan.sensor;
    setup.poses = scene.scan.poses;
    setup.pose =
        scene.scan.pose.value_or(setup.poses.empty() ? core::SensorPose{} : setup.poses.front());
    setup.subsamples = scene.scan.subsamples;
    setup.wall = scene.relay_wall;
    return core::scan_of_zones(setup);
}

}  // namespace

const Measurement& sensor_measurement() {
    static const Measurement row{"scan.sensing_points",
                                 validate_zones,
                                 [](const SceneDescription& scene) {
                                     return static_cast<double>(scene.scan.sensor->num_zones());
                                 },
                                 make_zones};
    return row;
}

}  // namespace renderer
