// SPDX-License-Identifier: MIT
#pragma once

#include "calib/fit/fit_result.h"
#include "renderer/core/progress.h"

namespace calib {

/// Finds the scene whose third bounce explains a capture.
///
/// Surfaces become closed-form histograms with analytic derivatives (forward_model.h); Ceres
/// minimises Poisson deviances or squares, from blurred and coarse data to sharp ones.
///
/// progress   asked between iterations whether to stop
/// returns    the best state with its uncertainty and what casts doubt on it; converged is false
///            when the last solve ran out of iterations or the model's light left the data
/// throws     core::Error when model and data do not fit together; core::Failure when nothing can
///            be started from, or the caller stops
/// source     design by the authors; see README.md
FitResult fit_scene(const FitInput& input, const core::Progress& progress);

}  // namespace calib
