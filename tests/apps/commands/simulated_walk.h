// SPDX-License-Identifier: MIT
#pragma once

#include "calib/track/track_file.h"
#include "calib/track/tracker.h"
#include "renderer/core/capture/sensor_footprint.h"

#include <cstdint>
#include <vector>

namespace test_support {

/// What walks, and before what.
struct WalkSettings {
    std::string sensor = "vl53l8";
    int frames = 220;
    int first = 40;  ///< frame in which the target appears
    int last = 190;  ///< frame in which it is gone again
    bool has_target = true;
    bool sensor_moves = true;  ///< along the wall, its pose known
    double wall_albedo = 0.6;
    double target_area_m2 = 0.05;
    double target_albedo = 0.4;
    double ambient_counts = 5.0;  ///< in every bin
    std::uint64_t seed = 0;
};

/// Frames of a simulated sensor with the truth beside them.
struct SimulatedWalk {
    calib::TrackSensor sensor;
    std::vector<calib::TrackFrame> frames;
    std::vector<calib::TrackedFrame> truth;
    std::vector<double> signal_counts;  ///< expected of the target, per frame
    double retro_strength = 0.0;        ///< counts of TargetResponse 1 for this target
};

/// Counts a retroreflective disc that walks 0.5 to 2 m from a wall.
///
/// It shares with the tracker where a sensor's zones look, and nothing else: zones of 8 x 8 points,
/// a disc of many points, pulses integrated over bins one by one, the direct return, a static
/// surface behind, crosstalk, dark counts and ambient light, drawn from Poisson distributions.
SimulatedWalk simulate_walk(const WalkSettings& settings);

}  // namespace test_support
