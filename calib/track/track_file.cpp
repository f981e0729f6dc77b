// SPDX-License-Identifier: MIT
#include "calib/track/track_file.h"

#include "renderer/core/settings/settings_json.h"

#include <fmt/core.h>

#include <cmath>

namespace calib {
namespace {

using core::Json;
using core::Vec3;

Json matrix_json(const core::Mat3& m) {
    Json rows = Json::array();
    for (int i = 0; i < 3; ++i) rows.push_back({m(i, 0), m(i, 1), m(i, 2)});
    return rows;
}

Json target_json(const TargetEstimate& target, const TrackSettings& settings) {
    Json json;
    json["id"] = target.id;
    json["position_m"] = core::write_value(reported_position_m(target, settings));
    json["covariance_m2"] = matrix_json(reported_covariance_m2(target, settings));
    json["probability"] = target.probability;
    json["strength"] = target.state.strength();
    if (target.state.mean.size() > kSeen) {
        const double sign = settings.moves_sensor() ? -1.0 : 1.0;
        json["velocity_m_per_s"] =
            core::write_value(Vec3(sign * target.state.mean.segment<3>(kSeen)));
    }
    return json;
}

Vec3 vector_of(const Json& json, const std::string& where) {
    Vec3 value;
    core::read_value(json, where, value);
    return value;
}

const Json& at(const Json& json, const char* key, const std::string& where) {
    if (json.is_object() && json.contains(key)) return json.at(key);
    throw core::Error(
        core::join_key(where, key), "is missing", "must be in every frame of a track");
}

TrackedPosition read_target(const Json& json, const std::string& where) {
    TrackedPosition target;
    target.position_m = vector_of(at(json, "position_m", where), where + ".position_m");
    if (json.contains("covariance_m2")) {
        std::array<Vec3, 3> rows;
        core::read_value(json["covariance_m2"], where + ".covariance_m2", rows);
        target.covariance_m2.emplace();
        for (int i = 0; i < 3; ++i) {
            target.covariance_m2->row(i) = rows[static_cast<std::size_t>(i)].transpose();
        }
    }
    return target;
}

}  // namespace

Vec3 reported_position_m(const TargetEstimate& target, const TrackSettings& settings) {
    const Vec3 position_m = target.state.position_m();
    if (!settings.moves_sensor()) return position_m;
    return settings.pose.whole().position_m + (*settings.target.position_m - position_m);
}

core::Mat3 reported_covariance_m2(const TargetEstimate& target, const TrackSettings& settings) {
    // The variance of a ball's points along an axis is a fifth of its squared radius.
    const double variance_m2 =
        std::pow(settings.noise.systematic_m, 2) + std::pow(settings.target.radius_m, 2) / 5.0;
    return target.state.position_covariance() + variance_m2 * core::Mat3::Identity();
}

Json frame_json(const FrameEstimate& frame, const TrackSettings& settings) {
    Json json;
    json["time_s"] = frame.time_s;
    if (frame.is_learning) json["learning"] = true;
    if (!frame.is_used) json["left_out"] = true;
    json["probability"] = frame.probability;
    json["log_likelihood"] = frame.log_likelihood;
    json["targets"] = Json::array();
    for (const TargetEstimate& target : frame.targets) {
        if (target.is_named) json["targets"].push_back(target_json(target, settings));
    }
    if (frame.pose && !settings.moves_sensor() && !settings.poses.empty()) {
        json["sensor_position_m"] = core::write_value(frame.pose->position_m);
    }
    if (!frame.warnings.empty()) json["warnings"] = frame.warnings;
    return json;
}

Json track_json(const std::vector<FrameEstimate>& frames,
                const TrackSettings& settings,
                const TrackSensor& sensor) {
    Json json;
    json["track_of"] = core::write_value(settings.free);
    json["settings"] = core::write_value(settings);
    json["wall"] = core::write_value(sensor.wall);
    json["spots_m"] = Json::array();
    for (const core::ZoneFootprint& zone : footprints_at(sensor, settings.pose.whole()).zones) {
        if (zone.center_m) json["spots_m"].push_back(core::write_value(*zone.center_m));
    }
    json["frames"] = Json::array();
    for (const FrameEstimate& frame : frames) json["frames"].push_back(frame_json(frame, settings));
    return json;
}

std::string track_csv(const std::vector<FrameEstimate>& frames, const TrackSettings& settings) {
    std::string text =
        "time_s,id,probability,x_m,y_m,z_m,var_x_m2,var_y_m2,var_z_m2,cov_xy_m2,cov_xz_m2,"
        "cov_yz_m2,strength,log_likelihood\n";
    for (const FrameEstimate& frame : frames) {
        for (const TargetEstimate& target : frame.targets) {
            if (!target.is_named) continue;
            const Vec3 p = reported_position_m(target, settings);
            const core::Mat3 c = reported_covariance_m2(target, settings);
            text += fmt::format("{:.9g},{},{:.6g},{:.6g},{:.6g},{:.6g},",
                                frame.time_s,
                                target.id,
                                target.probability,
                                p.x(),
                                p.y(),
                                p.z());
            text += fmt::format("{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},",
                                c(0, 0),
                                c(1, 1),
                                c(2, 2),
                                c(0, 1),
                                c(0, 2),
                                c(1, 2));
            text += fmt::format("{:.6g},{:.6g}\n", target.state.strength(), frame.log_likelihood);
        }
    }
    return text;
}

bool is_track(const Json& json) {
    if (!json.is_object() || !json.contains("frames") || !json["frames"].is_array()) return false;
    const Json& frames = json["frames"];
    return !frames.empty() && frames[0].is_object() && frames[0].contains("time_s") &&
           frames[0].contains("targets");
}

std::vector<TrackedFrame> read_track(const std::string& path) {
    const Json json = core::read_json_file(path);
    if (!is_track(json)) {
        throw core::Error(path, "is no track", "must list `frames` with `time_s` and `targets`");
    }
    std::vector<TrackedFrame> frames;
    for (std::size_t i = 0; i < json["frames"].size(); ++i) {
        const Json& item = json["frames"][i];
        const std::string where = fmt::format("{}: frames[{}]", path, i);
        TrackedFrame frame;
        core::read_value(at(item, "time_s", where), where + ".time_s", frame.time_s);
        frame.is_learning = item.value("learning", false) || item.value("left_out", false);
        const Json& targets = at(item, "targets", where);
        if (!targets.is_array()) core::throw_wrong_type(where + ".targets", targets, "a list");
        for (std::size_t t = 0; t < targets.size(); ++t) {
            frame.targets.push_back(
                read_target(targets[t], fmt::format("{}.targets[{}]", where, t)));
        }
        frames.push_back(std::move(frame));
    }
    return frames;
}

}  // namespace calib
