// SPDX-License-Identifier: MIT
#include "renderer/core/capture/sensor_model.h"

#include "renderer/core/nearest_name.h"
#include "renderer/core/settings/settings_json.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>

namespace core {

Json write_value(const SensorModel& model) {
    Json json = write_value<SensorModel>(model);
    json.erase("sources");
    return json;
}

void validate(const SensorModel& model, const std::string& where) {
    check_ranges(model, where);
    check_ranges(model.detector, join_key(where, "detector"));
    constexpr int kMostZones = 4096;
    require(model.num_zones() <= kMostZones,
            join_key(where, "zones"),
            fmt::format("{} zones", model.num_zones()),
            fmt::format("at most {}", kMostZones));
}

std::vector<std::string> shipped_sensors() {
    std::vector<std::string> names;
    for (const auto& [name, text] : shipped_sensor_texts()) names.emplace_back(name);
    return names;
}

SensorModel read_sensor_model(const std::string& name_or_path, const std::string& where) {
    SensorModel model;
    const auto& shipped = shipped_sensor_texts();
    const auto known = std::find_if(shipped.begin(), shipped.end(), [&](const auto& entry) {
        return entry.first == name_or_path;
    });
    const bool is_file = std::filesystem::path(name_or_path).extension() == ".json";
    if (known == shipped.end() && !is_file) {
        throw Error(where,
                    "found \"" + name_or_path + "\"",
                    did_you_mean(name_or_path, shipped_sensors()) +
                        fmt::format("must be one of {} or a .json file",
                                    fmt::join(shipped_sensors(), ", ")));
    }
    const std::string prefix = name_or_path + ": ";
    const Json json = known != shipped.end() ? parse_json(known->second, name_or_path)
                                             : read_json_file(name_or_path);
    read_value(json, prefix, model);
    validate(model, prefix);
    return model;
}

}  // namespace core
