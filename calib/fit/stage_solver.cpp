// SPDX-License-Identifier: MIT
#include "calib/fit/stage_solver.h"

#include "calib/model/state_vector.h"
#include "calib/statistics/quiet_ceres.h"
#include "renderer/core/error.h"
#include "renderer/core/statistics.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace calib {
namespace {

using renderer::Gradients;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Renders once for all residual blocks, and once for each point: a step is first looked at with its
// gradients by the line search, then again for its cost and for its Jacobian.
class SharedRender : public ceres::EvaluationCallback {
 public:
    SharedRender(FitObjective& objective, const StateVector& values)
        : objective_(objective), values_(values) {}

    void PrepareForEvaluation(bool with_jacobians, bool) override {
        std::vector<double> numbers = values_.numbers();
        if (numbers == rendered_ && (is_with_gradients_ || !with_jacobians)) return;
        objective_.evaluate(values_.state(), with_jacobians ? Gradients::With : Gradients::Without);
        rendered_ = std::move(numbers);
        is_with_gradients_ = with_jacobians;
    }

 private:
    FitObjective& objective_;
    const StateVector& values_;
    std::vector<double> rendered_;  ///< the numbers of the last render
    bool is_with_gradients_ = false;
};

// The rows of one wall point or pair: a loss then rejects it as a whole.
class PairCost : public ceres::CostFunction {
 public:
    PairCost(const SceneModel& model, const FitObjective& objective, std::size_t pair)
        : model_(model), objective_(objective), pair_(pair) {
        set_num_residuals(model.num_columns() + 1);
        for (const ParameterBlock& block : model.blocks()) {
            mutable_parameter_block_sizes()->push_back(StateVector::ambient_size(block));
        }
    }

    bool Evaluate(double const* const* parameters,
                  double* residuals,
                  double** jacobians) const override {
        const FitObjective::PairRows& rows = objective_.pair(pair_);
        Eigen::Map<Eigen::VectorXd>(residuals, rows.residual.size()) = rows.residual;
        if (!rows.residual.allFinite()) return false;
        if (jacobians == nullptr) return true;
        for (std::size_t b = 0; b < model_.blocks().size(); ++b) {
            if (jacobians[b] == nullptr) continue;
            const ParameterBlock& block = model_.blocks()[b];
            const auto columns = rows.jacobian.middleCols(block.first_column, block.columns);
            Eigen::Map<RowMajor> target(
                jacobians[b], columns.rows(), StateVector::ambient_size(block));
            if (block.row->effect == Effect::Rotates) {
                target = columns * StateVector::turn_by_quaternion(parameters[b]);
            } else {
                target = columns;
            }
        }
        return true;
    }

 private:
    const SceneModel& model_;
    const FitObjective& objective_;
    std::size_t pair_;
};

class PriorCost : public ceres::CostFunction {
 public:
    explicit PriorCost(LinearPrior prior) : prior_(std::move(prior)) {
        set_num_residuals(static_cast<int>(prior_.rows.rows()));
        mutable_parameter_block_sizes()->push_back(static_cast<int>(prior_.rows.cols()));
    }

    bool Evaluate(double const* const* p, double* residuals, double** jacobians) const override {
        const auto& [rows, sigma] = prior_;
        const Eigen::Map<const Eigen::VectorXd> parameters(p[0], rows.cols());
        Eigen::Map<Eigen::VectorXd>(residuals, rows.rows()) = rows * parameters / sigma;
        if (jacobians != nullptr && jacobians[0] != nullptr) {
            Eigen::Map<RowMajor>(jacobians[0], rows.rows(), rows.cols()) = rows / sigma;
        }
        return true;
    }

 private:
    LinearPrior prior_;
};

class StopCallback : public ceres::IterationCallback {
 public:
    explicit StopCallback(const SolveSettings& settings) : settings_(settings) {}
    ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
        if (settings_.report) settings_.report(summary.iteration);
        return settings_.stop_requested && settings_.stop_requested() ? ceres::SOLVER_ABORT
                                                                      : ceres::SOLVER_CONTINUE;
    }

 private:
    const SolveSettings& settings_;
};

// Misfits of wall points beyond this are outliers.
double loss_width(const FitObjective& objective, const SolveSettings& settings) {
    std::vector<double> squares;
    for (std::size_t i = 0; i < objective.num_pairs(); ++i) {
        squares.push_back(objective.pair(i).residual.squaredNorm());
    }
    return settings.loss_scale *
           std::sqrt(std::max(core::upper_median(std::move(squares)), 1e-300));
}

std::unique_ptr<ceres::LossFunction> make_loss(LossKind kind, double width) {
    if (kind == LossKind::Huber) return std::make_unique<ceres::HuberLoss>(width);
    if (kind == LossKind::Cauchy) return std::make_unique<ceres::CauchyLoss>(width);
    return nullptr;
}

void add_priors(const SceneModel& model,
                const SolveSettings& settings,
                const StateVector& values,
                ceres::Problem& problem) {
    for (std::size_t b = 0; b < model.blocks().size(); ++b) {
        const ParameterBlock& block = model.blocks()[b];
        double* parameters = values.blocks()[b];
        if (block.row->effect == Effect::Rotates) {
            problem.SetManifold(parameters, new ceres::QuaternionManifold);
        } else if (block.row->effect == Effect::AddsLight) {
            problem.SetParameterLowerBound(parameters, 0, settings.lowest_log_ambient);
        } else if (auto prior = model.prior_of(block, settings.prior)) {
            problem.AddResidualBlock(new PriorCost(std::move(*prior)), nullptr, parameters);
        }
    }
}

}  // namespace

SolveSummary solve_stage(const SceneModel& model,
                         FitObjective& objective,
                         const SolveSettings& settings,
                         SceneState& state) {
    const StateVector values(model, state);
    objective.evaluate(state, Gradients::Without);
    const double start_cost = objective.sum_of_squares();
    const auto loss = make_loss(settings.loss, loss_width(objective, settings));

    SharedRender render(objective, values);
    ceres::Problem::Options ownership;
    ownership.evaluation_callback = &render;
    ownership.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem problem(ownership);
    for (std::size_t pair = 0; pair < objective.num_pairs(); ++pair) {
        problem.AddResidualBlock(new PairCost(model, objective, pair), loss.get(), values.blocks());
    }
    add_priors(model, settings, values, problem);

    StopCallback stop(settings);
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
    options.max_num_iterations = settings.max_iterations;
    // Ceres' tolerance is relative to the cost, which grows with the number of bins: this makes it
    // about a thousandth of a unit of deviance.
    options.function_tolerance = 1e-3 / std::max(start_cost, 1.0);
    options.parameter_tolerance = 1e-8;
    options.num_threads = 1;  // parallel inside the render
    options.logging_type = ceres::SILENT;
    options.callbacks = {&stop};
    ceres::Solver::Summary summary;
    quiet_ceres();
    ceres::Solve(options, &problem, &summary);
    if (summary.termination_type == ceres::USER_FAILURE) throw core::Failure("fit", "interrupted");
    state = values.state();
    SolveSummary result;
    result.cost = summary.final_cost;
    result.iterations = static_cast<int>(summary.iterations.size());
    result.converged = summary.termination_type == ceres::CONVERGENCE;
    result.message = summary.message;
    return result;
}

Eigen::MatrixXd prior_information(const SceneModel& model, const SolveSettings& settings) {
    Eigen::MatrixXd information = Eigen::MatrixXd::Zero(model.num_columns(), model.num_columns());
    for (const ParameterBlock& block : model.blocks()) {
        if (const auto prior = model.prior_of(block, settings.prior)) {
            information.block(
                block.first_column, block.first_column, block.columns, block.columns) +=
                prior->rows.transpose() * prior->rows / (prior->sigma * prior->sigma);
        }
    }
    return information;
}

std::vector<double> loss_weights(const FitObjective& objective, const SolveSettings& settings) {
    const auto loss = make_loss(settings.loss, loss_width(objective, settings));
    if (!loss) return {};
    std::vector<double> weights;
    for (std::size_t i = 0; i < objective.num_pairs(); ++i) {
        double rho[3];
        loss->Evaluate(objective.pair(i).residual.squaredNorm(), rho);
        weights.push_back(rho[1]);
    }
    return weights;
}

}  // namespace calib
