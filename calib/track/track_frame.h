// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/observed_bins.h"
#include "renderer/core/capture/sensor_footprint.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace calib {

/// What a sensor counted in one frame.
struct TrackFrame {
    double time_s = 0.0;
    std::vector<double> counts;            ///< [zone][bin]; empty: the frame is missing
    core::ObservedBins observed;           ///< nothing: all bins
    std::optional<core::SensorPose> pose;  ///< nothing: the settings' own
    std::string name;                      ///< in messages; empty: its time
};

/// Throws core::Error naming frame and zone unless time and pose are numbers that can be meant, and
/// every bin of every zone holds a count. All frames pass here, those of files as those of lines.
void validate(const TrackFrame& frame, std::size_t num_zones, std::size_t num_bins);

}  // namespace calib
