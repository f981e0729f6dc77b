// SPDX-License-Identifier: MIT
#pragma once

#include "calib/fit/fit_data.h"
#include "renderer/core/capture/capture.h"

#include <vector>

namespace calib {

/// The point whose path lengths best fit the mean path length of each pair's excess light.
///
/// ambient    light per bin to be ignored
/// offset_m   per pair, part of the path lengths
/// throws     core::Failure when there is no light beyond the ambient one
/// source     trilateration by Gauss-Newton
core::Vec3 trilaterate(const core::WallScan& scan,
                       const FitData& data,
                       double ambient,
                       const std::vector<double>& offset_m);

/// Rotations spread over all orientations, the first the identity; the same for the same count.
std::vector<Eigen::Quaterniond> spread_rotations(int count);

/// Centres of clusters that points fall into: the mean of the points nearest to each.
///
/// points   at least one
/// source   farthest-point sampling, then the algorithm of [Lloyd1982]
std::vector<core::Vec3> cluster_centers(const std::vector<core::Vec3>& points, std::size_t count);

/// Points where a backprojection of the light not yet explained is largest, one after the other.
///
/// ambient    light per bin to be ignored
/// sigma_m    width of the response with its blur, within which a point's light is explained [m]
/// offset_m   per pair, part of the path lengths
std::vector<core::Vec3> brightest_points(const core::WallScan& scan,
                                         const FitData& data,
                                         double ambient,
                                         double sigma_m,
                                         const std::vector<double>& offset_m,
                                         int count);

}  // namespace calib
