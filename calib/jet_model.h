// SPDX-License-Identifier: MIT
#pragma once

#include "calib/model_pieces.h"
#include "calib/scene_model.h"
#include "renderer/core/capture.h"

#include <vector>

namespace calib {

/// The confocal model of one body by automatic derivatives throughout, geometry and histogram: a
/// reference for forward_model.h, many times slower and with none of its hand-written slopes.
///
/// state     pose of body 0
/// pair      of a confocal scan
/// returns   [bin][6] derivatives by translation and by turns about the world's axes; nothing is
///           hidden, albedo and constants are 1
std::vector<double> jet_slopes(const SceneModel& model,
                               const SceneState& state,
                               const std::vector<ModelPiece>& pieces,
                               const core::Scan& scan,
                               std::size_t pair,
                               const core::TimeAxis& axis,
                               double sigma_m);

}  // namespace calib
