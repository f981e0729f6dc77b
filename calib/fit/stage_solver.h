// SPDX-License-Identifier: MIT
#pragma once

#include "calib/fit/fit_objective.h"
#include "renderer/core/progress.h"

#include <Eigen/Dense>

#include <functional>
#include <string>

namespace calib {

/// What one solve ended with.
struct SolveSummary {
    double cost = 0.0;  ///< half the sum of squares, priors and loss included
    int iterations = 0;
    bool converged = false;
    std::string message;
};

/// What limits and weighs a solve.
struct SolveSettings {
    LossKind loss = LossKind::None;
    double loss_scale = 1.5;
    PriorSettings prior;
    double lowest_log_ambient = -40.0;
    int max_iterations = 60;
    std::function<bool()> stop_requested;
    std::function<void(int iterations)> report;  ///< called after every iteration; may be empty
};

/// Minimises an objective from `state`, which becomes the minimum, by Ceres' trust region.
/// throws   core::Failure when it is asked to stop
SolveSummary solve_stage(const SceneModel& model,
                         FitObjective& objective,
                         const SolveSettings& settings,
                         SceneState& state);

/// Second derivatives of half the sum of squared priors: of time zero and of rough vertices.
Eigen::MatrixXd prior_information(const SceneModel& model, const SolveSettings& settings);

/// Weight that the loss gives each wall point at the last evaluation; empty without a loss.
std::vector<double> loss_weights(const FitObjective& objective, const SolveSettings& settings);

}  // namespace calib
