// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/methods/light_cone.h"
#include "nlos/reconstruction/reconstruct_settings.h"
#include "nlos/solver/time_operator.h"

#include <vector>

namespace nlos {

/// Bins of v for every bin of range. With one, depths are off by up to half a bin, depending on
/// where in its bin a surface lies; more cost time in proportion.
inline constexpr double kVBinsPerRangeBin = 1.25;

/// Histograms of a confocal grid as the solver takes them, cut to the bins that hold light, and
/// what is known of their noise.
struct ConfocalProblem {
    Cone cone;                              ///< of these bins' ranges
    core::TimeAxis axis;                    ///< from and to the wall
    std::vector<float> values;              ///< [x][bin][y]
    std::vector<core::BinRange> observed;   ///< per column
    std::vector<float> background_per_bin;  ///< per column
    Likelihood likelihood;                  ///< not Auto
    std::vector<double> precision;          ///< per bin: about 1 / variance of its light
    TimeOperator time;  ///< of light in a unit in which its standard deviation is about 1
    double unit = 1.0;  ///< that unit, as content of a bin of v times range^power
    double photons_per_point = 0.0;  ///< of light, had it no background, that were as well known
};

/// Cuts the bins with light out of a capture, takes device legs off and weighs what is left.
///
/// Where device legs differ by no whole number of bins, a bin is split between two.
///
/// throws     core::Error when the axis has no positive range
ConfocalProblem make_confocal_problem(const MethodInput& input,
                                      const ReconstructSettings& settings);

}  // namespace nlos
