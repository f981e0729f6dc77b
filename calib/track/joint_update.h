// SPDX-License-Identifier: MIT
#pragma once

#include "calib/track/target_response.h"
#include "calib/track/target_state.h"

#include <functional>
#include <span>
#include <vector>

namespace calib {

/// What a frame counted, beside what is expected without targets; [zone][bin].
struct FrameCounts {
    std::span<const double> counts;
    std::span<const double> background;  ///< positive
    std::span<const double> weights;     ///< mean over variance; 0 where a bin says nothing
};

/// What targets became in the light of a frame.
struct JointUpdate {
    std::vector<Gaussian> targets;
    /// For each target the logarithm of how much likelier the frame is with it than without it, the
    /// others staying: integrated over its prior distribution by Laplace's method.
    std::vector<double> log_evidence;
    double log_likelihood = 0.0;  ///< of the frame at the most likely states, over that without any
    std::vector<double> signal;   ///< expected of all targets; [zone][bin]
};

/// Finds the most likely positions and strengths of all targets together, given their prior
/// distributions and Poisson counts, by Gauss-Newton steps, and their covariance from the Fisher
/// information there.
///
/// priors       independent of each other
/// hidden       positions with a positive distance from the wall: a step never leaves them
/// source       iterated extended Kalman filter [Bell1993]
JointUpdate update_jointly(const TargetResponse& response,
                           const FrameCounts& frame,
                           const std::vector<Gaussian>& priors,
                           const std::function<bool(const core::Vec3&)>& hidden);

}  // namespace calib
