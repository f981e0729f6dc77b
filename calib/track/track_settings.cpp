// SPDX-License-Identifier: MIT
#include "calib/track/track_settings.h"

#include "renderer/core/settings/settings_json.h"

namespace calib {
namespace {

void require_order(const std::array<double, 2>& range, const std::string& where) {
    core::require(range[0] < range[1], where + "[1]", range[1], "above the first number");
}

}  // namespace

void PoseSettings::complete(const core::SensorPose& other) {
    position_m = position_m.value_or(other.position_m);
    forward = forward.value_or(other.forward);
    up = up.value_or(other.up);
}

core::SensorPose PoseSettings::whole() const {
    return {position_m.value_or(core::Vec3::UnitZ()),
            forward.value_or(-core::Vec3::UnitZ()),
            up.value_or(core::Vec3::UnitY())};
}

void validate(const TrackSettings& s, const std::string& where) {
    core::check_ranges(s, where);
    core::check_ranges(s.target, core::join_key(where, "target"));
    core::check_ranges(s.motion, core::join_key(where, "motion"));
    core::check_ranges(s.background, core::join_key(where, "background"));
    core::check_ranges(s.noise, core::join_key(where, "noise"));
    core::check_ranges(s.existence, core::join_key(where, "existence"));
    core::check_ranges(s.search, core::join_key(where, "search"));
    const std::string search = core::join_key(where, "search");
    if (s.search.x_range_m) require_order(*s.search.x_range_m, search + ".x_range_m");
    if (s.search.y_range_m) require_order(*s.search.y_range_m, search + ".y_range_m");
    require_order(s.search.z_range_m, search + ".z_range_m");
    core::validate(s.pose.whole(), core::join_key(where, "pose"));
    for (std::size_t i = 0; i < s.poses.size(); ++i) {
        core::validate(s.poses[i], core::join_key(where, "poses") + "[" + std::to_string(i) + "]");
    }
    if (s.wall) core::validate(*s.wall, core::join_key(where, "wall"));
    if (s.moves_sensor() && !s.target.position_m) {
        throw core::Error(core::join_key(where, "free"),
                          "is sensor_pose without target.position_m",
                          "must come with the place where the target stands [m]");
    }
    if (s.moves_sensor() && !s.poses.empty()) {
        throw core::Error(core::join_key(where, "poses"),
                          "found with free sensor_pose",
                          "must be left out: `pose` says where the sensor's way begins");
    }
}

TrackSettings read_track_settings(const std::string& path,
                                  const std::vector<std::string>& overrides) {
    TrackSettings settings;
    core::read_value(core::read_json_file(path), path, settings);
    for (const std::string& text : overrides) core::apply_override(settings, text);
    validate(settings, path);
    return settings;
}

}  // namespace calib
