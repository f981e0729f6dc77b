// SPDX-License-Identifier: MIT
#pragma once

#include "calib/track/tracker.h"
#include "nlos/detector/count_sampling.h"
#include "renderer/core/capture/instrument_response.h"
#include "renderer/core/random.h"

#include <cmath>
#include <cstdint>
#include <vector>

namespace test_support {

/// A sensor of 3 x 3 zones, 1 m before the wall z = 0.
inline calib::TrackSensor small_sensor(
    core::SensorIllumination illumination = core::SensorIllumination::Flood) {
    core::SensorModel model;
    model.name = "small";
    model.zones = {3, 3};
    model.fov_deg = {50.0, 50.0};
    model.num_bins = 64;
    model.illumination = illumination;
    core::SensorSetup setup;
    setup.model = model;
    setup.subsamples = 2;
    setup.pose.position_m = core::Vec3(0.0, 0.0, 1.0);
    setup.wall.size_m = {10.0, 10.0};
    calib::TrackSensor sensor;
    sensor.axis = model.time_axis();
    sensor.axis.opl_start_m = 1.5;
    sensor.wall = setup.wall;
    sensor.setup = setup;
    sensor.sigma_m = 0.1;
    sensor.frame_s = 0.05;
    return sensor;
}

inline calib::TargetResponse response_of(const calib::TrackSensor& sensor,
                                         const calib::TargetSettings& target = {}) {
    return {calib::footprints_at(sensor, sensor.setup->pose),
            sensor.axis,
            target,
            sensor.setup->model.illumination,
            sensor.opl_origin,
            sensor.sigma_m};
}

/// Settings that look for few targets in a small box: quick.
inline calib::TrackSettings small_settings() {
    calib::TrackSettings settings;
    settings.pose.position_m = core::Vec3(0.0, 0.0, 1.0);
    settings.search.x_range_m = std::array{-1.0, 1.0};
    settings.search.y_range_m = std::array{-0.6, 0.6};
    settings.search.z_range_m = {0.4, 1.6};
    settings.search.cell_m = 0.2;
    settings.background.frames = 10;
    return settings;
}

/// Counts of targets over an even background.
inline std::vector<double> draw_counts(const calib::TargetResponse& response,
                                       const std::vector<core::Vec3>& targets,
                                       double strength,
                                       double background,
                                       std::uint64_t seed) {
    std::vector<double> expected(response.size(), background);
    for (const core::Vec3& target : targets) {
        std::vector<double> unit(response.size(), 0.0);
        response.evaluate(target, unit, {});
        for (std::size_t i = 0; i < unit.size(); ++i) expected[i] += strength * unit[i];
    }
    core::Rng rng(seed, 0, 0);
    for (double& count : expected) count = static_cast<double>(nlos::sample_poisson(rng, count));
    return expected;
}

}  // namespace test_support
