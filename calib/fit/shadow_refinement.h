// SPDX-License-Identifier: MIT
#pragma once

#include "calib/fit/fit_driver.h"

#include <Eigen/Dense>

namespace calib {

/// What the data say of the free parameters at a solution.
struct RefinedSolution {
    Eigen::MatrixXd information;    ///< inverse of the solution's covariance, for independent noise
    bool is_settled = true;         ///< within a standard deviation of where the score vanishes
    Eigen::VectorXd element_error;  ///< of every parameter, what elements of this size may leave
};

/// Takes a solution to where the whole score vanishes, that of moving shadow edges included.
///
/// Expected data m(p) = f(p, v(p)) depend on parameters p directly and by way of what wall points
/// see, v. Solves hold v, and alternate with tracing it anew: they end where f_p^T W (n - m) = 0,
/// f_p the gradients with v held, W the inverse variances and n the data. With all gradients
/// J = f_p + f_v v_p, such solutions scatter with A^-1 (f_p^T W f_p) A^-T, A = f_p^T W J
/// [Godambe1960], which is not the inverse of f_p^T W f_p, nor as narrow as that of J^T W J. So
/// Newton's steps (J^T W J)^-1 J^T W (n - m), with v traced anew after each, lead on to the maximum
/// of the likelihood, whose Fisher information J^T W J is. Without shadow edges J is f_p, and
/// nothing moves.
///
/// The edges tell as much as the model knows them: the elements become so small that the steps
/// settle. That needs a start within several standard deviations, which the solves give.
///
/// Elements err alike in all bins, which no scatter of the data shows. Without shadow edges a
/// single Newton's step with several times as many elements takes most of that error away, and its
/// length bounds what is left: errors fall about as the number of elements grows.
///
/// stage    the last one; replaced by a finer one. Refreshed at `state`
/// state    becomes the refined solution
RefinedSolution refine(const FitDriver& driver, FitDriver::Stage& stage, SceneState& state);

}  // namespace calib
