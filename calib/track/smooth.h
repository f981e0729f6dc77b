// SPDX-License-Identifier: MIT
#pragma once

#include "calib/track/tracker.h"

#include <vector>

namespace calib {

/// Replaces what was believed of every target after each frame by what is believed of it after all
/// of them: positions, covariances and the probability that it was there.
///
/// frames   as Tracker::step() returned them, in order
/// source   Rauch, Tung and Striebel's smoother [Rauch1965]
void smooth(std::vector<FrameEstimate>& frames, const TrackSettings& settings);

}  // namespace calib
