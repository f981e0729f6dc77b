// SPDX-License-Identifier: MIT
#pragma once

#include "calib/fit/fit_driver.h"
#include "calib/fit/fit_result.h"
#include "calib/statistics/uncertainty.h"

namespace calib {

/// Ambient light per bin of the capture: a parameter, or eliminated by least squares.
double ambient_of(const FitDriver::Stage& stage, const SceneState& state);

/// What a solution says of objects, points and set-up, with standard deviations.
///
/// last             the stage that it was solved on, updated to `state`
/// noise_variance   of each value of the data, by least squares
FittedValues fitted_values(const FitDriver& driver,
                           const FitDriver::Stage& last,
                           const SceneState& state,
                           const Uncertainty& uncertainty,
                           double noise_variance);

}  // namespace calib
