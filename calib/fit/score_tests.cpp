// SPDX-License-Identifier: MIT
#include "calib/fit/solution.h"
#include "calib/model/state_vector.h"

#include <Eigen/Dense>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace calib {
namespace {

constexpr double kNotableStep = 5.0;
constexpr double kLeastFall = 0.5;  // of what the deviance must fall by along a notable step

// Frees what score tests look at, as far as the response allows.
FreeSettings with_all_freedoms(const FitDriver& driver) {
    FreeSettings free = driver.settings.free;
    for (const Parameter* row : parameters()) {
        if (row->misfit.name == nullptr) continue;
        if (row->refusal != nullptr && row->refusal(driver.settings.response)) continue;
        free.parameters.insert(row->name);
    }
    return free;
}

// What is free beside one block of a model with more freedoms, and then that block.
std::vector<Eigen::Index> columns_beside(const SceneModel& fitted,
                                         const SceneModel& model,
                                         const ParameterBlock& block) {
    std::vector<Eigen::Index> columns;
    for (const ParameterBlock& other : model.blocks()) {
        if (fitted.find(*other.row, other.item) == nullptr) continue;
        for (int c = 0; c < other.columns; ++c) columns.push_back(other.first_column + c);
    }
    columns.push_back(block.first_column);
    return columns;
}

// By how much the deviance falls along a step, at most. Where light begins at the edge of a bin a
// score says less than it seems to: the bin before it is dark on one side of the state alone.
double fall_along(const SceneModel& model,
                  const FitDriver::Stage& stage,
                  const SceneState& state,
                  const Eigen::VectorXd& step) {
    const auto deviance = [&](double fraction) {
        stage.objective->evaluate(moved_by(model, state, fraction * step),
                                  renderer::Gradients::Without);
        return stage.objective->sum_of_squares();
    };
    const double here = deviance(0.0);
    double least = here;
    for (const double fraction : {1.0, 0.5, 0.25}) least = std::min(least, deviance(fraction));
    return here - least;
}

}  // namespace

void warn_of_misfits(const FitDriver& driver, const SceneState& state, FitResult& result) {
    FitSettings settings = driver.settings;
    settings.free = with_all_freedoms(driver);
    const SceneModel model(driver.geometry, settings);
    const FitDriver::Stage stage = driver.make_stage(model, 0.0);
    stage.model->refresh(state);
    stage.objective->evaluate(state, renderer::Gradients::With);
    Eigen::VectorXd score = Eigen::VectorXd::Zero(model.num_columns());
    for (std::size_t i = 0; i < stage.objective->num_pairs(); ++i) {
        const FitObjective::PairRows& rows = stage.objective->pair(i);
        score -= rows.jacobian.transpose() * rows.residual;
    }
    const Eigen::MatrixXd information = stage.objective->fisher(state, {});
    for (const ParameterBlock& block : model.blocks()) {
        const MisfitWords& words = block.row->misfit;
        if (words.name == nullptr || driver.model->find(*block.row) != nullptr) continue;
        const std::vector<Eigen::Index> columns = columns_beside(*driver.model, model, block);
        const Eigen::MatrixXd part = information(columns, columns);
        const Eigen::VectorXd right = score(columns);
        const Eigen::MatrixXd covariance = generalized_inverse(part);
        Eigen::VectorXd all_steps = Eigen::VectorXd::Zero(model.num_columns());
        all_steps(columns) = covariance * right;
        const double step = all_steps[columns.back()];
        const double sigma = std::sqrt(std::max(0.0, covariance.diagonal().tail<1>()[0]));
        if (!(std::abs(step) > kNotableStep * sigma)) continue;
        const double least_fall = kLeastFall * kNotableStep * kNotableStep;
        if (fall_along(model, stage, state, all_steps) < least_fall) continue;
        result.warnings.push_back(
            fmt::format("the data ask for another value of {}: {:+.3g} {} ({:.0f} standard "
                        "deviations); free or correct it",
                        words.name,
                        words.unit * step,
                        words.unit_name,
                        std::abs(step) / sigma));
    }
}

}  // namespace calib
