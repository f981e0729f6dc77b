// SPDX-License-Identifier: MIT
#pragma once

#include "calib/model_pieces.h"
#include "calib/scene_model.h"
#include "renderer/core/capture.h"

#include <cstdint>
#include <vector>

namespace calib {

inline constexpr int kVisibilityRays = 4;  ///< per piece and wall point, one bit each

/// True when no surface of the model can hide another: all lie in one plane.
bool is_planar(const SceneModel& model, const SceneState& state);

/// Which quarters of every piece each wall point sees, by rays through the renderer's scene.
///
/// returns   masks [point][piece]
std::vector<std::uint8_t> trace_masks(const SceneModel& model,
                                      const SceneState& state,
                                      const std::vector<ModelPiece>& pieces,
                                      const core::Scan& scan,
                                      const core::WallPoints& points);

}  // namespace calib
