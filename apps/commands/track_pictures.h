// SPDX-License-Identifier: MIT
#pragma once

#include "calib/track/tracker.h"
#include "nlos/pictures/panel.h"

#include <vector>

namespace apps {

/// A frame beside what explains it; [zone][bin].
struct ExplainedFrame {
    double time_s = 0.0;
    std::vector<double> counts;
    std::vector<double> background;
    std::vector<double> signal;
};

/// Top view and front view of wall, sensor and paths with 95 % ellipses, in the wall's frame; and
/// the histograms of a frame beside those that background and targets explain.
std::vector<nlos::Panel> track_panels(const std::vector<calib::FrameEstimate>& frames,
                                      const calib::TrackSettings& settings,
                                      const calib::TrackSensor& sensor,
                                      const ExplainedFrame& shown);

}  // namespace apps
