// SPDX-License-Identifier: MIT
#include "calib/statistics/uncertainty.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace calib {
namespace {

constexpr double kMinEigenvalue = 0.01;
constexpr double kSingular = 1e-12;
constexpr double kNotableCorrelation = 0.9;

std::string describe(const Eigen::VectorXd& direction, const std::vector<std::string>& names) {
    std::vector<Eigen::Index> order(static_cast<std::size_t>(direction.size()));
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = static_cast<Eigen::Index>(i);
    std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
        return std::abs(direction[a]) > std::abs(direction[b]);
    });
    std::string text;
    for (const Eigen::Index i : order) {
        const double component = direction[i] * (direction[order[0]] < 0.0 ? -1.0 : 1.0);
        if (std::abs(component) < 0.3) break;
        if (!text.empty()) text += component < 0.0 ? " against " : " with ";
        text += names[static_cast<std::size_t>(i)];
    }
    return text;
}

}  // namespace

Uncertainty assess(const Eigen::MatrixXd& information, const std::vector<std::string>& names) {
    const Eigen::Index size = information.rows();
    Uncertainty result;
    Eigen::VectorXd scale(size);
    std::vector<bool> is_unknown(static_cast<std::size_t>(size));
    for (Eigen::Index i = 0; i < size; ++i) {
        const auto item = static_cast<std::size_t>(i);
        is_unknown[item] = !(information(i, i) > 0.0);
        scale[i] = is_unknown[item] ? 1.0 : 1.0 / std::sqrt(information(i, i));
        if (is_unknown[item]) {
            result.unidentifiable.push_back(names[item] + ": the data do not depend on it");
        }
    }
    Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
    for (Eigen::Index i = 0; i < size; ++i) {
        if (is_unknown[static_cast<std::size_t>(i)]) scaled(i, i) = 1.0;
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
    const Eigen::VectorXd& values = eigen.eigenvalues();  // ascending
    const double largest = values[size - 1];
    Eigen::VectorXd inverse(size);
    for (Eigen::Index i = 0; i < size; ++i) {
        inverse[i] = 1.0 / std::max(values[i], kSingular * largest);
        if (values[i] < kMinEigenvalue) {
            result.unidentifiable.push_back(describe(eigen.eigenvectors().col(i), names));
        }
    }
    result.condition_number = largest / std::max(values[0], kSingular * largest);
    const Eigen::MatrixXd& vectors = eigen.eigenvectors();
    result.covariance = scale.asDiagonal() *
                        (vectors * inverse.asDiagonal() * vectors.transpose()) * scale.asDiagonal();
    result.sigma = result.covariance.diagonal().cwiseSqrt();
    for (Eigen::Index i = 0; i < size; ++i) {
        if (is_unknown[static_cast<std::size_t>(i)]) {
            result.sigma[i] = std::numeric_limits<double>::infinity();
        }
        for (Eigen::Index j = 0; j < i; ++j) {
            const double value = result.covariance(i, j) /
                                 std::sqrt(result.covariance(i, i) * result.covariance(j, j));
            if (std::abs(value) <= kNotableCorrelation) continue;
            result.correlations.push_back(
                {names[static_cast<std::size_t>(j)], names[static_cast<std::size_t>(i)], value});
        }
    }
    return result;
}

Eigen::MatrixXd generalized_inverse(const Eigen::MatrixXd& matrix) {
    constexpr double kRounding = 1e-14;
    const Eigen::VectorXd diagonal = matrix.diagonal();
    const Eigen::VectorXd scale = (diagonal.array() > 0.0).select(diagonal.array().rsqrt(), 0.0);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale.asDiagonal() * matrix *
                                                               scale.asDiagonal());
    const Eigen::VectorXd& values = eigen.eigenvalues();  // ascending
    const double zero = kRounding * values[values.size() - 1];
    const Eigen::VectorXd inverse = (values.array() > zero).select(values.array().inverse(), 0.0);
    return scale.asDiagonal() *
           (eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose()) *
           scale.asDiagonal();
}

}  // namespace calib
