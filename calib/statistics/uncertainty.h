// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Dense>

#include <string>
#include <vector>

namespace calib {

/// Two parameters that the data hardly tell apart.
struct Correlation {
    std::string a;
    std::string b;
    double value = 0.0;
};

/// What the information matrix at a solution says.
struct Uncertainty {
    Eigen::VectorXd sigma;  ///< one standard deviation per parameter; infinite when unknown
    Eigen::MatrixXd covariance;
    std::vector<Correlation> correlations;  ///< above 0.9
    /// Largest over smallest eigenvalue of the information, scaled to a unit diagonal.
    double condition_number = 1.0;
    std::vector<std::string> unidentifiable;  ///< directions, in words
};

/// Inverts an information matrix and names what it leaves open.
///
/// A direction counts as unidentifiable when its eigenvalue, after scaling, is below 0.01: moving
/// along it at most a tenth as visible as each of its parameters alone.
Uncertainty assess(const Eigen::MatrixXd& information, const std::vector<std::string>& names);

/// Generalised inverse of a symmetric matrix without negative eigenvalues, such as an information
/// or a Gram matrix: of its form with unit diagonal, without the directions whose eigenvalue is
/// zero up to rounding.
Eigen::MatrixXd generalized_inverse(const Eigen::MatrixXd& matrix);

}  // namespace calib
