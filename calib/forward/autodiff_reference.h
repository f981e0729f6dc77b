// SPDX-License-Identifier: MIT
#pragma once

#include "calib/forward/forward_model.h"

#include <vector>

namespace calib {

/// The confocal model of one body by automatic derivatives throughout, geometry and histogram: a
/// reference for forward_model.h, many times slower and with none of its hand-written gradients.
///
/// state     pose of body 0
/// light     of one confocal scan with a Gaussian response, whose elements, axis and width are
/// taken pair      of its scan returns   [bin][6] derivatives by translation and by turns about the
/// world's axes; nothing is
///           hidden, albedo and constants are 1
std::vector<double> autodiff_jacobian(const SceneModel& model,
                                      const SceneState& state,
                                      const ForwardModel& light,
                                      std::size_t pair);

}  // namespace calib
