// SPDX-License-Identifier: MIT
#pragma once

#include "calib/track/tracker.h"

#include <optional>
#include <string>
#include <vector>

namespace calib {

/// What to tell where targets explain frames better with their bins in reverse: a sentence that
/// names the setting. Some hundred frames are tried; nothing when time runs forward, or when no
/// target shows either way.
///
/// frames       of the track, all of one sensor
/// background   of settings.background.file, if any
/// estimates    what Tracker::step() said of the frames
std::optional<std::string> reversed_time_warning(const TrackSettings& settings,
                                                 const TrackSensor& sensor,
                                                 const std::vector<TrackFrame>& frames,
                                                 const std::vector<TrackFrame>& background,
                                                 const std::vector<FrameEstimate>& estimates);

}  // namespace calib
