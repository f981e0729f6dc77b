// SPDX-License-Identifier: MIT
#pragma once

#include "calib/model/scene_model.h"

#include <string>
#include <utility>
#include <vector>

namespace calib {

/// Whether two states show a body in different places, or nearly in the same but turned by so much
/// that it covers itself only because it is nearly symmetric.
bool are_different_poses(const SceneModel& model, const SceneState& a, const SceneState& b);

/// States in which one body with free rotation is turned so that it nearly covers itself: by
/// quarters and halves about its principal axes, which is where a solve of a nearly symmetric
/// body may end by mistake. Exact symmetries are left out.
///
/// max_distance   between vertices of body and turned body that still nearly meet, over the extent
/// returns         names, such as "target turned by 90 degrees", and states
std::vector<std::pair<std::string, SceneState>> symmetric_poses(const SceneModel& model,
                                                                const SceneState& state,
                                                                double max_distance);

}  // namespace calib
