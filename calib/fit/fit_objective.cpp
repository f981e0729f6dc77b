// SPDX-License-Identifier: MIT
#include "calib/fit/fit_objective.h"

#include "calib/statistics/poisson_deviance.h"
#include "calib/statistics/uncertainty.h"
#include "renderer/core/system/parallel.h"

#include <algorithm>
#include <cmath>

namespace calib {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using renderer::Gradients;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Gradient = Eigen::Map<const RowMajor>;

}  // namespace

FitObjective::FitObjective(ForwardModel& model,
                           const FitData& data,
                           bool is_poisson,
                           Elimination elimination,
                           int num_columns)
    : model_(model),
      data_(data),
      is_poisson_(is_poisson),
      num_columns_(num_columns),
      rows_(model.scan().num_pairs()) {
    if (elimination.scale) eliminated_.push_back(0);
    if (elimination.ambient) eliminated_.push_back(1);
}

void FitObjective::evaluate(const SceneState& state, Gradients gradients) {
    model_.update(state, gradients);
    const bool with_gradients = gradients == Gradients::With;
    std::vector<MatrixXd> grams(rows_.size());
    core::parallel_for(rows_.size(), [&](std::size_t pair) {
        thread_local PairModel expected;
        model_.evaluate(pair, expected);
        grams[pair] = is_poisson_ ? poisson_gram(pair, expected) : linear_gram(pair, expected);
    });
    if (!is_poisson_) eliminate(grams, with_gradients);
    core::parallel_for(rows_.size(), [&](std::size_t pair) {
        compress(grams[pair], with_gradients, rows_[pair]);
    });
}

// [J r]^T [J r] of the signed deviances.
MatrixXd FitObjective::poisson_gram(std::size_t pair, const PairModel& expected) const {
    const core::BinRange seen = data_.observed_range(pair);
    const bool with_gradients = !expected.gradients.empty();
    const Eigen::Index columns = with_gradients ? num_columns_ : 0;
    thread_local RowMajor rows;
    rows.resize(seen.size(), columns + 1);
    for (Eigen::Index b = 0; b < seen.size(); ++b) {
        const auto i = static_cast<std::size_t>(seen.begin + b);
        const double mean = std::max(expected.mean[i], data_.min_mean);
        const double counted = data_.values[pair * expected.mean.size() + i];
        const Residual residual = signed_deviance(mean, counted);
        rows(b, columns) = residual.value;
        const double* gradients = expected.gradients.data() + i * static_cast<std::size_t>(columns);
        for (Eigen::Index c = 0; c < columns; ++c) rows(b, c) = residual.gradient * gradients[c];
    }
    MatrixXd gram = MatrixXd::Zero(columns + 1, columns + 1);
    gram.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
    return gram.selfadjointView<Eigen::Lower>();
}

// [dm m 1 y]^T [dm m 1 y]: all that elimination and projection need.
MatrixXd FitObjective::linear_gram(std::size_t pair, const PairModel& expected) const {
    const core::BinRange seen = data_.observed_range(pair);
    const Eigen::Index columns = expected.gradients.empty() ? 0 : num_columns_;
    thread_local RowMajor rows;
    rows.resize(seen.size(), columns + 3);
    if (columns > 0) {
        const double* first = expected.gradients.data() + seen.begin * columns;
        rows.leftCols(columns) = Gradient(first, seen.size(), columns);
    }
    for (Eigen::Index b = 0; b < seen.size(); ++b) {
        const auto i = static_cast<std::size_t>(seen.begin + b);
        rows(b, columns) = expected.mean[i];
        rows(b, columns + 1) = 1.0;
        rows(b, columns + 2) = data_.values[pair * expected.mean.size() + i];
    }
    MatrixXd gram = MatrixXd::Zero(columns + 3, columns + 3);
    gram.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose());
    return gram.selfadjointView<Eigen::Lower>();
}

// Maps [dm m 1 y] to [J r], r = a m + b - y.
void FitObjective::eliminate(std::vector<MatrixXd>& grams, bool with_gradients) {
    const Eigen::Index columns = with_gradients ? num_columns_ : 0;
    MatrixXd total = MatrixXd::Zero(columns + 3, columns + 3);
    for (const MatrixXd& gram : grams) total += gram;
    solve_linear_factors(total, columns);
    differentiate_linear_factors(total, columns);

    MatrixXd transform = MatrixXd::Zero(columns + 3, columns + 1);
    transform.topLeftCorner(columns, columns).diagonal().setConstant(linear_[0]);
    for (std::size_t i = 0; i < eliminated_.size(); ++i) {
        transform.row(columns + eliminated_[i]).head(columns) =
            linear_gradient_.row(static_cast<Eigen::Index>(i));
    }
    transform.col(columns).tail<3>() << linear_[0], linear_[1], -1.0;
    for (MatrixXd& gram : grams) gram = transform.transpose() * gram * transform;
}

// The least-squares solution (a, b) over the eliminated part B of [m 1], B^T r = 0.
void FitObjective::solve_linear_factors(const MatrixXd& total, Eigen::Index columns) {
    linear_ = {1.0, 0.0};
    if (eliminated_.empty()) return;
    std::vector<Eigen::Index> basis;
    for (const Eigen::Index i : eliminated_) basis.push_back(columns + i);
    const Eigen::Index y = columns + 2;
    VectorXd right = total(basis, y);
    const bool has_known_scale = eliminated_.front() != 0;
    if (has_known_scale) right -= total(basis, columns);
    linear_inverse_ = generalized_inverse(total(basis, basis));
    linear_(eliminated_) = linear_inverse_ * right;
}

// (B^T B) d(a, b) = -(dm^T r, 0) - B^T dm a for every parameter, and dr = a dm + m da + db.
void FitObjective::differentiate_linear_factors(const MatrixXd& total, Eigen::Index columns) {
    const Eigen::Index m = columns;
    const Eigen::Index one = columns + 1;
    const Eigen::Index y = columns + 2;
    const auto [a, b] = std::array{linear_[0], linear_[1]};
    linear_gradient_ = MatrixXd::Zero(static_cast<Eigen::Index>(eliminated_.size()), columns);
    for (Eigen::Index c = 0; c < linear_gradient_.cols() && !eliminated_.empty(); ++c) {
        const double with_residual = a * total(c, m) + b * total(c, one) - total(c, y);
        const Eigen::Vector2d side(-with_residual - a * total(m, c), -a * total(one, c));
        const VectorXd of_eliminated = side(eliminated_);
        linear_gradient_.col(c) = linear_inverse_ * of_eliminated;
    }
}

// A Gram matrix of any rank as rows of its factor, by Cholesky's method with the largest pivot
// first.
//
// What a pair's bins do not tell leaves pivots that are rounding: there it ends, and the rest of
// the residual gets a row of its own. Divided by such pivots, rounding would grow to residuals of
// any size (Eigen's LDLT takes pivots by the diagonal it began with, and cannot be stopped there).
void FitObjective::compress(const MatrixXd& gram, bool with_gradients, PairRows& rows) const {
    const Eigen::Index columns = num_columns_;
    rows.residual = VectorXd::Zero(columns + 1);
    if (!with_gradients) {
        rows.jacobian.resize(0, 0);
        rows.residual(0) = std::sqrt(std::max(0.0, gram(0, 0)));
        return;
    }
    constexpr double kMinPivot = 1e-12;  // of columns of length 1
    const VectorXd lengths = gram.diagonal().head(columns).cwiseMax(0.0).cwiseSqrt();
    const VectorXd scale = (lengths.array() > 0.0).select(lengths, 1.0);
    const VectorXd inverse = scale.cwiseInverse();
    MatrixXd left =
        inverse.asDiagonal() * gram.topLeftCorner(columns, columns) * inverse.asDiagonal();
    VectorXd left_of_residual = inverse.cwiseProduct(gram.col(columns).head(columns));
    rows.jacobian = MatrixXd::Zero(columns + 1, columns);
    for (Eigen::Index k = 0; k < columns; ++k) {
        Eigen::Index pivot = 0;
        const double largest = left.diagonal().maxCoeff(&pivot);
        if (!(largest > kMinPivot)) break;
        const double root = std::sqrt(largest);
        const VectorXd row = left.col(pivot) / root;
        rows.residual(k) = left_of_residual(pivot) / root;
        left.noalias() -= row * row.transpose();
        left_of_residual -= rows.residual(k) * row;
        left.row(pivot).setZero();
        left.col(pivot).setZero();
        rows.jacobian.row(k) = row.cwiseProduct(scale);
    }
    rows.residual(columns) =
        std::sqrt(std::max(0.0, gram(columns, columns) - rows.residual.squaredNorm()));
}

// What is eliminated varies with the data at given parameters, and with the parameters.
std::array<double, 2> FitObjective::linear_sigma(double noise_variance,
                                                 const MatrixXd& covariance) const {
    std::array<double, 2> sigma{0.0, 0.0};
    for (std::size_t k = 0; k < eliminated_.size(); ++k) {
        const auto i = static_cast<Eigen::Index>(k);
        const auto gradient = linear_gradient_.row(i);
        sigma[static_cast<std::size_t>(eliminated_[k])] =
            std::sqrt(noise_variance * linear_inverse_(i, i) +
                      gradient.dot(covariance * gradient.transpose()));
    }
    return sigma;
}

double FitObjective::sum_of_squares() const {
    double sum = 0.0;
    for (const PairRows& rows : rows_) sum += rows.residual.squaredNorm();
    return sum;
}

MatrixXd FitObjective::fisher(const SceneState& state, const std::vector<double>& weights) {
    model_.update(state, Gradients::With);
    std::vector<MatrixXd> parts(rows_.size());
    core::parallel_for(rows_.size(), [&](std::size_t pair) {
        thread_local PairModel expected;
        model_.evaluate(pair, expected);
        const core::BinRange seen = data_.observed_range(pair);
        const double* first =
            expected.gradients.data() + static_cast<std::ptrdiff_t>(seen.begin) * num_columns_;
        RowMajor rows = Gradient(first, seen.size(), num_columns_);
        for (Eigen::Index b = 0; b < seen.size(); ++b) {
            const double mean =
                std::max(expected.mean[static_cast<std::size_t>(seen.begin + b)], data_.min_mean);
            rows.row(b) /= std::sqrt(mean);
        }
        parts[pair] = (weights.empty() ? 1.0 : weights[pair]) * (rows.transpose() * rows);
    });
    MatrixXd sum = MatrixXd::Zero(num_columns_, num_columns_);
    for (const MatrixXd& part : parts) sum += part;
    return sum;
}

}  // namespace calib
