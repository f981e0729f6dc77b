// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/reconstruct.h"
#include "renderer/core/settings/json_fwd.h"
#include "renderer/scene/scene.h"

#include <string>
#include <vector>

namespace apps {

using Overrides = std::vector<std::string>;  ///< `key.path=value` texts

/// The slices that the costs of methods are compared on.
inline const std::string kSlices = "volume.z_range_m=[0.45,1.05]";

/// Notes what is asked of a row of a table, unless nothing is, and whether it and all before hold:
/// `target` is what was asked, `met` yes, no, or empty without a target.
void judge(bool is_asked, const std::string& text, bool is_met, core::Json& row);

/// A random smooth surface before a wall of 1 m, and what a confocal scan of 32 x 32 points in 256
/// bins of 8 mm gets of it, without noise: every other one a tilted rectangle, the rest bent.
///
/// Its centre is 0.5 to 0.9 m away, its half width 0.12 to 0.35 m, its tilt up to 25 degrees; bends
/// are bumps or dents of up to a fifth of the width.
struct RandomCapture {
    renderer::Scene scene;
    core::Capture capture;
};

/// number   of the surface; the same number gives the same surface
RandomCapture make_random_capture(int number);

/// Counts of it with this many expected in the brightest bin, over background light of a fiftieth.
core::Capture random_counts(const core::Capture& clean, double peak_counts, int seed);

/// One reconstruction and what it took.
struct ReconstructRun {
    nlos::Reconstruction result;
    double cpu_seconds = 0.0;
    double bytes = 0.0;       ///< on top of what was held before
    double peak_bytes = 0.0;  ///< of the whole process
};

ReconstructRun run_reconstruction(const core::Capture& capture, const Overrides& overrides);

}  // namespace apps
