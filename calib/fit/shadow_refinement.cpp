// SPDX-License-Identifier: MIT
#include "calib/fit/solution.h"
#include "calib/model/state_vector.h"

#include <algorithm>
#include <cmath>

namespace calib {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Newton {
    MatrixXd information;
    VectorXd step;
    /// Of the step, in standard deviations per parameter.
    double length() const {
        return std::sqrt(step.dot(information * step) / static_cast<double>(step.size()));
    }
};

// J^T W J and the step, by columns scaled to a like size.
Newton newton_at(const FitDriver& driver, FitDriver::Stage& stage, const SceneState& state) {
    const SceneModel& model = *driver.model;
    FitObjective& objective = *stage.objective;
    objective.evaluate(state, renderer::Gradients::With);
    const std::vector<double> weights = loss_weights(objective, driver.solve_settings);
    const auto size = model.num_columns();
    Newton newton{MatrixXd::Zero(size, size), VectorXd::Zero(size)};
    VectorXd score = VectorXd::Zero(size);
    for (std::size_t i = 0; i < objective.num_pairs(); ++i) {
        const FitObjective::PairRows& rows = objective.pair(i);
        const double weight = weights.empty() ? 1.0 : weights[i];
        score -= weight * (rows.jacobian.transpose() * rows.residual);
        newton.information += weight * (rows.jacobian.transpose() * rows.jacobian);
    }
    if (driver.is_poisson) {
        newton.information = objective.fisher(state, weights);
    } else {
        // Squares take their noise from the residual.
        const double freedom =
            std::max(1.0, static_cast<double>(stage.data->num_observed()) - size);
        const double per_variance = freedom / std::max(objective.sum_of_squares(), 1e-300);
        newton.information *= per_variance;
        score *= per_variance;
    }
    // Priors pull to 0, where their parameters start.
    const MatrixXd prior = prior_information(model, driver.solve_settings);
    newton.information += prior;
    score -= prior * difference(model, model.start(), state);

    newton.step = generalized_inverse(newton.information) * score;
    return newton;
}

// Edges are to be known well, but every element is seen or not from every point.
double refinement(const ForwardModel& model) {
    constexpr double kMaxRefinement = 10.0;
    constexpr double kMaxViews = 4e5;  // points times elements
    const core::WallScan& scan = model.scan();
    const double points = static_cast<double>(scan.sensing.size());
    const double views = points * static_cast<double>(model.num_elements());
    return std::clamp(kMaxViews / views, 1.0, kMaxRefinement);
}

// One step towards what finer elements say, if it leads there.
RefinedSolution refine_elements(const FitDriver& driver,
                                FitDriver::Stage& stage,
                                SceneState& state) {
    constexpr double kFinerElements = 4.0;
    stage = driver.make_stage(*driver.model, 0.0, kFinerElements);
    stage.model->refresh(state);
    const Newton before = newton_at(driver, stage, state);
    const SceneState start = state;
    state = moved_by(*driver.model, state, before.step);
    stage.model->refresh(state);
    const Newton after = newton_at(driver, stage, state);
    const VectorXd error = before.step.cwiseAbs();
    const VectorXd none = VectorXd::Zero(error.size());
    if (after.length() < 0.5 * before.length()) {
        return {after.information, true, error / (kFinerElements - 1.0)};
    }
    state = start;
    stage.model->refresh(state);
    const bool is_far = error.allFinite() && before.length() > 1.0;
    return {newton_at(driver, stage, state).information, true, is_far ? error : none};
}

}  // namespace

RefinedSolution refine(const FitDriver& driver, FitDriver::Stage& stage, SceneState& state) {
    constexpr int kMaxSteps = 8;
    constexpr double kSettled = 0.1;  // standard deviations per parameter
    constexpr double kTooFar = 12.0;  // for Newton's method
    const auto look_anew = [&] {
        stage.model->refresh(state);
        stage.model->find_shadow_edges(state);
        return newton_at(driver, stage, state);
    };
    stage.model->refresh(state);
    const auto size = driver.model->num_columns();
    if (!stage.model->has_shadow_edges()) return refine_elements(driver, stage, state);
    stage = driver.make_stage(*driver.model, 0.0, refinement(*stage.model));
    Newton newton = look_anew();
    for (int i = 0; i < kMaxSteps; ++i) {
        if (!(newton.length() > kSettled && newton.length() < kTooFar)) break;
        state = moved_by(*driver.model, state, newton.step);
        newton = look_anew();
    }
    return {newton.information, newton.length() < 1.0, VectorXd::Zero(size)};
}

}  // namespace calib
