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
    TimeOperator time;  ///< of light in a unit in which its standard deviation is about 1 (less
                        ///< where the solver is confined and depth smeared)
    double unit = 1.0;  ///< that unit, as content of a bin of v times range^power
    double photons_per_point = 0.0;  ///< of light, had it no background, that were as well known
    bool is_confined = false;        ///< all scatterers lie before the wall's footprint
    bool finds_background = false;   ///< so, and none was given
    bool is_under_spot = false;      ///< so, and a spot blurs light over wall points
    double blur = 1.0;               ///< depth_blur(), at least 1
};

/// Observed bins of all columns, at least 1.
double num_observed_bins(const ConfocalProblem& data);

/// How far the response smears depth: its standard deviation as range, in distances of wall points;
/// 0 without one.
double depth_blur(const MethodInput& input);

/// Cuts the bins with light out of a capture, takes device segments off and weighs what is left.
///
/// Where device segments differ by no whole number of bins, a bin is split between two.
///
/// is_confined   whether all scatterers lie before the wall's footprint, and the model tells all
///               of their light
/// throws        core::Error when the axis has no positive range
ConfocalProblem make_confocal_problem(const MethodInput& input,
                                      const ReconstructSettings& settings,
                                      bool is_confined);

}  // namespace nlos
