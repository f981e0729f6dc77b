// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/solver/confocal_problem.h"

#include <vector>

namespace nlos {

/// The weight of total variation unless one is set, in units of voxel_noise(): more where photons,
/// or points with radiance, are few.
double default_weight(const ConfocalProblem& data);

/// The relative change at which iterations stop unless one is set. Few points pull weakly: it falls
/// with the root of their fraction.
double default_tolerance(const ConfocalProblem& data);

/// What the noise of light at v makes of a voxel at u, in units of its standard deviation: the
/// root of its mean square over the wall points that see the voxel, and of the fraction of these
/// that were observed.
std::vector<double> voxel_noise(const ConfocalProblem& data, const WallGrid& grid);

}  // namespace nlos
