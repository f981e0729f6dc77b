// SPDX-License-Identifier: MIT
#pragma once

#include "calib/track/target_response.h"
#include "calib/track/target_search.h"
#include "calib/track/track_settings.h"
#include "renderer/core/capture/capture.h"
#include "renderer/core/capture/relay_wall.h"
#include "renderer/core/capture/sensor_footprint.h"
#include "renderer/core/capture/time_axis.h"

#include <optional>
#include <string>
#include <vector>

namespace calib {

/// What counted the frames: a sensor before a wall, or spots of a wall of which only the middles
/// are known, each lit and seen by its own zone.
struct TrackSensor {
    core::TimeAxis axis;
    core::RelayWall wall;
    std::optional<core::SensorSetup> setup;
    std::vector<core::Vec3> spots_m;  ///< without `setup`: one per zone
    core::OplOrigin opl_origin = core::OplOrigin::Device;
    core::Vec3 device_m = core::Vec3::Zero();  ///< without `setup`: of laser and detector
    double sigma_m = 0.0;                      ///< of pulse and jitter in path length
    double frame_s = 0.1;                      ///< from frame to frame, where frames do not say

    std::size_t num_zones() const {
        return setup ? static_cast<std::size_t>(setup->model.num_zones()) : spots_m.size();
    }
};

/// The plane through points that lie in one, as a wall that reaches over them all, its normal along
/// +z, or away from the origin where they stand at a right angle to that.
///
/// where    names the points in messages
/// throws   core::Error for fewer than three points, points on a line, and points more than a tenth
///          of their extent off the plane
core::RelayWall wall_through(const std::vector<core::Vec3>& points_m, const std::string& where);

/// Footprints of zones whose middles alone are known: each reaches half way to its neighbours, and
/// is lit and seen evenly. Light that returns to a spot is shared by its area.
core::SensorFootprints footprints_of_spots(const std::vector<core::Vec3>& spots_m,
                                           const core::RelayWall& wall,
                                           const core::Vec3& device_m);

/// Footprints with the sensor at a pose, if it has a set-up.
core::SensorFootprints footprints_at(const TrackSensor& sensor, const core::SensorPose& pose);

/// The response to targets with the sensor's zones at these footprints.
TargetResponse response_at(const TrackSensor& sensor,
                           const core::SensorFootprints& footprints,
                           const TargetSettings& target);

/// Where targets are looked for, given what the zones see.
SearchBox search_box(const TrackSettings& settings,
                     const core::RelayWall& wall,
                     const core::SensorFootprints& footprints);

}  // namespace calib
