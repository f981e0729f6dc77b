// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/compare/metrics.h"
#include "renderer/core/types.h"

#include <vector>

namespace nlos {

/// The middle value, or the mean of the middle two; `values` must not be empty.
double median(std::vector<double> values);

/// Angle between two directions [deg].
double angle_deg(const core::Vec3& a, const core::Vec3& b);

/// Mean and median of angles between normals; leaves `metrics` alone when there are none.
void score_angles(const std::vector<double>& angles_deg, Metrics& metrics);

}  // namespace nlos
