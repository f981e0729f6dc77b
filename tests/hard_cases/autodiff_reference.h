// SPDX-License-Identifier: MIT
#pragma once

#include "calib/forward/forward_model.h"

#include <vector>

namespace hard_cases {

/// Jacobian of the confocal model of one body by automatic differentiation throughout, geometry and
/// histogram: a reference for the analytic gradients of forward_model.h, many times slower.
///
/// state     pose of body 0
/// light     a confocal scan with a Gaussian response; its elements, axis and width are used
/// pair      of its scan
/// returns   [bin][6] derivatives by translation and by rotation about the world's axes, of a model
///           in which nothing is hidden and albedo and constants are 1
std::vector<double> autodiff_jacobian(const calib::SceneModel& model,
                                      const calib::SceneState& state,
                                      const calib::ForwardModel& light,
                                      std::size_t pair);

}  // namespace hard_cases
