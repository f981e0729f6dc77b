// SPDX-License-Identifier: MIT
#include "calib/fit/fit_objective.h"

#include "calib/statistics/poisson_deviance.h"
#include "calib/statistics/uncertainty.h"
#include "renderer/core/parallel.h"

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
      elimination_(elimination),
      num_columns_(num_columns),
      rows_(model.scan().num_pairs()) {}

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

// With r = a m + b - y and (a, b) the least-squares solution over B = [m 1], B^T r = 0 gives
// (B^T B) d(a, b) = -(dm^T r, 0) - B^T dm a for every parameter, and dr = a dm + m da + db.
void FitObjective::eliminate(std::vector<MatrixXd>& grams, bool with_gradients) {
    const Eigen::Index columns = with_gradients ? num_columns_ : 0;
    const Eigen::Index m = columns;
    const Eigen::Index one = columns + 1;
    const Eigen::Index y = columns + 2;
    MatrixXd total = MatrixXd::Zero(columns + 3, columns + 3);
    for (const MatrixXd& gram : grams) total += gram;

    std::vector<Eigen::Index> basis;
    if (elimination_.scale) basis.push_back(m);
    if (elimination_.ambient) basis.push_back(one);
    const auto size = static_cast<Eigen::Index>(basis.size());
    MatrixXd normal(size, size);
    VectorXd right(size);
    for (Eigen::Index i = 0; i < size; ++i) {
        for (Eigen::Index j = 0; j < size; ++j) {
            normal(i, j) =
                total(basis[static_cast<std::size_t>(i)], basis[static_cast<std::size_t>(j)]);
        }
        right(i) = total(basis[static_cast<std::size_t>(i)], y);
        if (!elimination_.scale) right(i) -= total(one, m);
    }
    if (size > 0) linear_inverse_ = generalized_inverse(normal);
    const VectorXd linear = linear_inverse_ * right;
    linear_gradient_ = MatrixXd::Zero(size, columns);
    Eigen::Index next = 0;
    scale_ = elimination_.scale ? linear(next++) : 1.0;
    ambient_ = elimination_.ambient ? linear(next) : 0.0;

    // transform maps [dm m 1 y] to [J r].
    MatrixXd transform = MatrixXd::Zero(columns + 3, columns + 1);
    transform.topLeftCorner(columns, columns).diagonal().setConstant(scale_);
    transform(m, columns) = scale_;
    transform(one, columns) = ambient_;
    transform(y, columns) = -1.0;
    for (Eigen::Index c = 0; c < columns && size > 0; ++c) {
        VectorXd side(size);
        next = 0;
        if (elimination_.scale) {
            const double with_residual =
                scale_ * total(c, m) + ambient_ * total(c, one) - total(c, y);
            side(next++) = -with_residual - scale_ * total(m, c);
        }
        if (elimination_.ambient) side(next) = -scale_ * total(one, c);
        const VectorXd change = linear_inverse_ * side;
        linear_gradient_.col(c) = change;
        next = 0;
        if (elimination_.scale) transform(m, c) = change(next++);
        if (elimination_.ambient) transform(one, c) = change(next);
    }
    for (MatrixXd& gram : grams) gram = transform.transpose() * gram * transform;
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
    Eigen::Index next = 0;
    for (const std::size_t i : {0, 1}) {
        if (!(i == 0 ? elimination_.scale : elimination_.ambient)) continue;
        const auto gradient = linear_gradient_.row(next);
        sigma[i] = std::sqrt(noise_variance * linear_inverse_(next, next) +
                             gradient.dot(covariance * gradient.transpose()));
        ++next;
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
