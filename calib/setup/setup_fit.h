// SPDX-License-Identifier: MIT
#pragma once

#include "calib/setup/setup_model.h"
#include "calib/setup/setup_observations.h"

#include <Eigen/Dense>

#include <limits>
#include <string>
#include <vector>

namespace calib {

/// The set-up nearest to what was observed, before anybody asks how near that is.
struct SetupFit {
    SetupValues values{};
    std::vector<int> free;  ///< SetupParameters that were not held
    Eigen::MatrixXd information;
    std::vector<double> length_misfit_m;  ///< modelled minus measured, of all points
    std::vector<double> spot_misfit_px;   ///< distance from where the camera saw them, likewise
    double chi_square = std::numeric_limits<double>::infinity();  ///< of what counts
    double degrees_of_freedom = 0.0;
    double length_rms_m = 0.0;  ///< of the points that count
    double noise_rms_m = 0.0;   ///< what counting photons explains of it
    double spot_rms_px = 0.0;
    std::string at_bound;  ///< a parameter whose value is the last that is allowed; empty: none

    bool is_found() const { return chi_square < std::numeric_limits<double>::infinity(); }
    /// About 1 when noise explains the misfit.
    double reduced() const { return chi_square / degrees_of_freedom; }
};

/// Least squares over all that counts, from many starts. Not found: no start leads to a set-up
/// whose beams meet the wall.
SetupFit fit_setup(const SetupObservations& observations);

/// The same where some points may be far off: large misfits count by their logarithm.
///
/// start   where to begin, what least squares found
SetupFit fit_setup_robustly(const SetupObservations& observations, const SetupFit& start);

/// What may be wrong with the path length of a point: counting, and that light may have been sorted
/// into bins before the response spread it.
double length_error_m(const SetupObservations& observations, std::size_t point);

/// The same of a spot in the camera's image: finding it there, and the camera's own calibration.
double spot_error_px(const SetupObservations& observations);

/// How far off each point is, in standard deviations: path length or spot, whichever is farther.
std::vector<double> point_misfits(const SetupObservations& observations, const SetupFit& fit);

}  // namespace calib
