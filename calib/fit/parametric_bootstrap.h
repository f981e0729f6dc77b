// SPDX-License-Identifier: MIT
#pragma once

#include "calib/fit/fit_driver.h"

namespace calib {

/// Scatter of refits to counts drawn from a fitted model: what the Fisher information, which holds
/// for many photons, understates when there are few.
///
/// stage    the last one, of Poisson data
/// state    the fit; every refit starts from it and from its turned bodies, and keeps the best
/// returns  root mean square change per column
/// source   parametric bootstrap [Efron1993]
Eigen::VectorXd bootstrap_scatter(const FitDriver& driver,
                                  const FitDriver::Stage& stage,
                                  const SceneState& state,
                                  const core::Progress& progress);

}  // namespace calib
