// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"

#include <string>
#include <vector>

namespace calib {

/// Shape of the instrument response.
enum class ResponseShape { Gaussian, GaussianExponential };

/// A direct return's path length as the axis reads it, time zero included.
struct DirectReturn {
    double opl_m = 0.0;
    double sigma_m = 0.0;
    double counts = 0.0;
};

/// What the peaks of direct returns tell together.
struct DirectReturns {
    std::vector<DirectReturn> points;
    double sigma_m = 0.0;  ///< of the response's Gaussian core, in path length
    double sigma_error_m = 0.0;
    double tail_m = 0.0;  ///< mean of its exponential tail; 0 without one
    double tail_error_m = 0.0;
    double ambient = 0.0;  ///< counts per bin
    double ambient_error = 0.0;
    double deviance = 0.0;
    double expected_deviance = 0.0;
    ResponseShape shape = ResponseShape::Gaussian;  ///< without a tail where none was found
    std::vector<std::string> warnings;
};

/// Fits a peak per point and one response for all by maximum likelihood, far below a bin's width.
///
/// capture   counts with one direct return per histogram
/// shape     of the response
/// throws    core::Error when a histogram holds no light or negative counts; core::Failure when
///           peaks are clipped, or the fit does not converge
/// source    likelihood of Poisson counts; the response's cumulative distributions are core's
DirectReturns fit_direct_returns(const core::Capture& capture, ResponseShape shape);

}  // namespace calib

template <>
struct core::EnumNames<calib::ResponseShape> {
    static constexpr auto value =
        names_from_zero<calib::ResponseShape>("gaussian", "gaussian_exponential");
};
