// SPDX-License-Identifier: MIT
#pragma once

#include "apps/dataset/item_plan.h"
#include "renderer/core/progress.h"

#include <optional>

namespace apps {

/// Finds the tolerance of elements with which all items of a recipe are computed, so that not each
/// of them needs pilot runs of its own, which cost more than small scans themselves.
///
/// The first `calibration_items` items are computed at a few wall points with several tolerances
/// and, as a reference, to a fifth of the error. The coarsest tolerance counts that keeps all of
/// them within three quarters of scene.render.target_error; the rest is for items that are worse.
///
/// progress  asked whether to stop
/// throws    core::Failure when it is to stop
/// returns   nothing where items have to find their own: without calibration items or a target
///           error, with draws of render settings, or when no tolerance does
std::optional<double> find_element_tolerance(const Recipe& recipe,
                                             MeshLibrary& meshes,
                                             const core::Progress& progress);

}  // namespace apps
