// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/time_axis.h"
#include "renderer/core/types.h"

#include <array>
#include <vector>

namespace test_support {

/// The confocal third bounce of one flat triangle as an integral over circular arcs: the reference
/// that approximations are measured against.
///
/// corners       of the triangle [m]
/// wall_point    illumination and sensing point [m]; the triangle lies on the side of its normal
/// wall_normal   unit, towards the triangle
/// axis          bins of optical path length
/// returns       per bin, the integral over the triangle of (n_w.d)^2 (n.d)^2 / |d|^8, d from the
///               wall point to the surface: H for albedo and BSDF constants left out
/// source        derived in exact_arcs.cpp
std::vector<double> confocal_arcs(const std::array<core::Vec3, 3>& corners,
                                  const core::Vec3& wall_point,
                                  const core::Vec3& wall_normal,
                                  const core::TimeAxis& axis);

}  // namespace test_support
