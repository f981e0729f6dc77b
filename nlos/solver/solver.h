// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/methods/method_input.h"
#include "nlos/reconstruction/reconstruct_settings.h"

namespace nlos {

/// The statistical solver: the scene that makes the histograms most likely, given that it has few
/// edges and little in it. What a set-up does to light (response, spot, background, bins that were
/// not observed) is part of the model instead of being taken off the data.
///
/// Confocal scans of even planar grids, with voxel columns at their points, go the way of
/// confocal_solver.h, all others that of pair_solver.h.
Volume solve(const MethodInput& input, const ReconstructSettings& settings, std::size_t num_slabs);

/// Memory that solve() takes on top of its input [bytes].
double solve_bytes(const MethodInput& input,
                   const ReconstructSettings& settings,
                   std::size_t num_slabs);

}  // namespace nlos
