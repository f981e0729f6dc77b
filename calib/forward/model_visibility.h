// SPDX-License-Identifier: MIT
#pragma once

#include "calib/forward/model_elements.h"
#include "calib/model/scene_model.h"
#include "renderer/core/capture/capture.h"
#include "renderer/geometry/visibility_mask.h"

#include <vector>

namespace calib {

/// True when no surface of the model can hide another: all lie in one plane.
bool is_planar(const SceneModel& model, const SceneState& state);

/// Which parts of every element each wall point sees, by rays through the renderer's scene.
///
/// The centres of an element's quarters are asked first; only where they disagree, so that the edge
/// of a shadow falls on the element, the other parts are asked too.
///
/// returns   masks [point][element]
std::vector<renderer::VisibilityMask> trace_masks(const SceneModel& model,
                                                  const SceneState& state,
                                                  const std::vector<ModelElement>& elements,
                                                  const core::Scan& scan,
                                                  const core::WallPoints& points);

}  // namespace calib
