// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"

#include <vector>

namespace core {

/// Where points lie and how far they spread, by the eigenvectors of their covariance.
struct PrincipalAxes {
    Vec3 center_m{0.0, 0.0, 0.0};  ///< mean of the points [m]
    Mat3 axes = Mat3::Identity();  ///< unit vectors as columns, the narrowest first; either sign
    Vec3 spread_m{0.0, 0.0, 0.0};  ///< root mean square distance from the mean along each [m]
};

/// Principal axes of a set of points; of no points, the world's axes at the origin.
PrincipalAxes principal_axes(const std::vector<Vec3>& points_m);

}  // namespace core
