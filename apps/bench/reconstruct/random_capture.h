// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"
#include "renderer/scene/scene.h"

namespace apps {

/// A random smooth surface before a wall of 1 m, and what a scan of 32 x 32 points in 256 bins
/// of 8 mm gets of it, without noise: every other one a tilted rectangle, the rest bent.
///
/// Its centre is 0.5 to 0.9 m away, its half width 0.12 to 0.35 m, its tilt up to 25 degrees; bends
/// are bumps or dents of up to a fifth of the width.
struct RandomCapture {
    renderer::Scene scene;
    core::Capture capture;
};

/// number    of the surface; the same number gives the same surface
/// pattern   of the scan
RandomCapture make_random_capture(int number,
                                  core::ScanPattern pattern = core::ScanPattern::Confocal);

/// Counts of it with this many expected in the brightest bin, over background light of a fiftieth.
core::Capture random_counts(const core::Capture& clean, double peak_counts, int seed);

}  // namespace apps
