// SPDX-License-Identifier: MIT
#pragma once

#include "calib/track/tracker.h"
#include "renderer/core/settings/json_fwd.h"

#include <optional>
#include <string>
#include <vector>

namespace calib {

/// A target in a frame of a track file.
struct TrackedPosition {
    core::Vec3 position_m;
    std::optional<core::Mat3> covariance_m2;
};

/// A frame of a track file: the targets that it names.
struct TrackedFrame {
    double time_s = 0.0;
    bool is_learning = false;
    std::vector<TrackedPosition> targets;
};

/// Where a target is. Where the sensor's pose is free, where the sensor is: where it stood at
/// settings.pose plus what the target seemed to move the other way.
core::Vec3 reported_position_m(const TargetEstimate& target, const TrackSettings& settings);

/// The covariance of a target's position: what counting leaves open, settings.noise.systematic_m
/// of the model, and which part of a body the light comes from.
core::Mat3 reported_covariance_m2(const TargetEstimate& target, const TrackSettings& settings);

/// What is believed after a frame, as TRACK.json holds it and as live answers say it.
core::Json frame_json(const FrameEstimate& frame, const TrackSettings& settings);

/// TRACK.json's content: settings, wall, spots and frames.
core::Json track_json(const std::vector<FrameEstimate>& frames,
                      const TrackSettings& settings,
                      const TrackSensor& sensor);

/// A line per frame and named target, under a line of names.
std::string track_csv(const std::vector<FrameEstimate>& frames, const TrackSettings& settings);

/// True for JSON that lists frames with targets.
bool is_track(const core::Json& json);

/// The frames of a TRACK.json, or of the truth beside it.
/// throws   core::Error naming file and key
std::vector<TrackedFrame> read_track(const std::string& path);

}  // namespace calib
