// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/progress.h"
#include "renderer/core/random.h"
#include "renderer/core/settings/json_fwd.h"
#include "renderer/material/scene_geometry.h"

#include <string>
#include <vector>

namespace apps {

/// One or two spheres and up to three parallelograms, of any albedo, behind the wall of the default
/// scene; they may touch and hide one another.
renderer::SceneGeometry random_geometry(core::Rng& rng);

/// `third_bounce` to 5, 2 and 1 %, a row for each, on random scenes of spheres and parallelograms
/// that hide and touch one another, in confocal, single and exhaustive scans by turns.
core::Json bench_target_errors(int num_scenes, const core::Progress& progress);

/// `third_bounce` to 0.05 % against `path` bin by bin, on scenes as they are but for 16 of their
/// wall points, in confocal, single and exhaustive scans, a row for each.
///
/// throws   core::Error for a scene with a camera
core::Json bench_agreement(const std::vector<std::string>& scenes, const core::Progress& progress);

/// What `third_bounce` takes to 1 %, a row for each of: the scene's histogram, gates of one bin of
/// 10 mm where 10, 50 and 90 % of its light have arrived, and 16 x 16 by 16 x 16 pairs of the same
/// wall.
core::Json bench_third_bounce_costs(const std::string& scene_path, int repeats);

}  // namespace apps
