// SPDX-License-Identifier: MIT
#pragma once

#include "calib/fit/fit_data.h"
#include "calib/forward/forward_model.h"

#include <Eigen/Dense>

#include <array>
#include <vector>

namespace calib {

/// Which linear factors least squares solves for in closed form.
struct Elimination {
    bool scale = false;
    bool ambient = false;
};

/// Residuals of all pairs, compressed: each pair's many bins become at most columns + 1 rows with
/// the same normal equations, J^T J, J^T r and r^T r.
class FitObjective {
 public:
    /// One pair: rows of Jacobian and residual.
    struct PairRows {
        Eigen::MatrixXd jacobian;  ///< empty unless gradients were wanted
        Eigen::VectorXd residual;
    };

    /// model, data   must outlive this
    FitObjective(ForwardModel& model,
                 const FitData& data,
                 bool is_poisson,
                 Elimination elimination,
                 int num_columns);

    void evaluate(const SceneState& state, renderer::Gradients gradients);
    const PairRows& pair(std::size_t index) const { return rows_[index]; }
    std::size_t num_pairs() const { return rows_.size(); }
    int num_columns() const { return num_columns_; }

    /// Data per model and per bin, as least squares eliminated them at the last evaluation.
    double scale() const { return linear_[0]; }
    double ambient() const { return linear_[1]; }
    /// Standard deviations of scale() and ambient(), as far as they were eliminated.
    ///
    /// noise_variance   of each of the data's values
    /// covariance       of the parameters; the last evaluation had gradients
    std::array<double, 2> linear_sigma(double noise_variance,
                                       const Eigen::MatrixXd& covariance) const;
    double sum_of_squares() const;

    /// Fisher information of Poisson counts at a state: sum of J^T J / mean.
    /// weights   per pair; empty: 1
    Eigen::MatrixXd fisher(const SceneState& state, const std::vector<double>& weights);

 private:
    Eigen::MatrixXd poisson_gram(std::size_t pair, const PairModel& model) const;
    Eigen::MatrixXd linear_gram(std::size_t pair, const PairModel& model) const;
    void eliminate(std::vector<Eigen::MatrixXd>& grams, bool with_gradients);
    void solve_linear_factors(const Eigen::MatrixXd& total, Eigen::Index columns);
    void differentiate_linear_factors(const Eigen::MatrixXd& total, Eigen::Index columns);
    void compress(const Eigen::MatrixXd& gram, bool with_gradients, PairRows& rows) const;

    ForwardModel& model_;
    const FitData& data_;
    bool is_poisson_;
    std::vector<Eigen::Index> eliminated_;  ///< 0: scale, 1: ambient
    int num_columns_;
    std::vector<PairRows> rows_;
    Eigen::Vector2d linear_{1.0, 0.0};  ///< scale and ambient
    Eigen::MatrixXd linear_gradient_;   ///< of what is eliminated, by parameter
    Eigen::MatrixXd linear_inverse_;    ///< of its normal equations
};

}  // namespace calib
