// SPDX-License-Identifier: MIT
#pragma once

#include "calib/fit/fit_driver.h"
#include "calib/fit/fit_result.h"
#include "calib/statistics/uncertainty.h"

#include <Eigen/Dense>

// What becomes of the last stage's solution: it is refined, its values and their scatter are
// reported, and what casts doubt on them is named.
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

/// Ambient light per bin of the capture: a parameter, or eliminated by least squares.
double ambient_of(const FitDriver::Stage& stage, const SceneState& state);

/// What a solution says of objects, points and set-up, with standard deviations.
///
/// last             the stage that it was solved on, updated to `state`
/// noise_variance   of each value of the data, by least squares
FittedValues fitted_values(const FitDriver& driver,
                           const FitDriver::Stage& last,
                           const SceneState& state,
                           const Uncertainty& uncertainty,
                           double noise_variance);

/// Scatter of refits to counts drawn from a fitted model: what the Fisher information, which holds
/// for many photons, underestimates when there are few.
///
/// stage    the last one, of Poisson data
/// state    the fit; every refit starts from it and from its turned bodies, and keeps the best
/// returns  root mean square change per column
/// source   parametric bootstrap [Efron1993]
Eigen::VectorXd bootstrap_scatter(const FitDriver& driver,
                                  const FitDriver::Stage& stage,
                                  const SceneState& state,
                                  const core::Progress& progress);

/// Standard deviations above which a deviance says that the model does not explain the data.
inline constexpr double kNotableExcess = 5.0;

/// How alike the residuals of neighbouring bins, or of neighbouring pairs, are: the larger of the
/// two correlations, as a magnitude, or 0 where chance explains it. Noise is independent; what is
/// left of noise-free data is the error of the capture and of the model's elements.
double residual_correlation(const FitAgreement& fit);

/// Adds warnings of what makes a fit's reported errors doubtful: light beyond the axis, bounds,
/// data that the model does not explain and what would explain them, wild wall points. Without
/// light of the model in the data, result.converged becomes false.
///
/// stage    the last one
/// result   with model and deviance
void add_warnings(const FitDriver& driver,
                  const FitDriver::Stage& stage,
                  const SceneState& state,
                  FitResult& result);

/// Score tests of Poisson data: warns of fixed quantities that one Newton step would move by more
/// than 5 standard deviations, were they free beside all that is, where the deviance falls along
/// it.
void warn_of_misfits(const FitDriver& driver, const SceneState& state, FitResult& result);

/// Sets result.converged to false when the data do not depend on where an object is: its sigma is
/// then infinite.
void check_dependence(const SceneModel& model, FitResult& result);

}  // namespace calib
