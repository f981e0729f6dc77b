// SPDX-License-Identifier: MIT
#pragma once

#include "calib/fit/fit_driver.h"

namespace calib {

/// Standard deviations above which a deviance says that the model does not explain the data.
inline constexpr double kNotableExcess = 5.0;

/// How alike the residuals of neighbouring bins, or of neighbouring pairs, are: the larger of the
/// two correlations, as a magnitude, or 0 where chance explains it. Noise is independent; what is
/// left of noise-free data is the error of the capture and of the model's elements.
double residual_correlation(const FitAgreement& fit);

/// Adds warnings of what makes a fit's stated errors doubtful: light beyond the axis, bounds, data
/// that the model does not explain and what would explain them, wild wall points. Without light of
/// the model in the data, result.converged becomes false.
///
/// stage    the last one
/// result   with model and deviance
void add_warnings(const FitDriver& driver,
                  const FitDriver::Stage& stage,
                  const SceneState& state,
                  FitResult& result);

/// Sets result.converged to false when the data do not depend on where an object is: its sigma is
/// then infinite.
void check_dependence(const SceneModel& model, FitResult& result);

}  // namespace calib
