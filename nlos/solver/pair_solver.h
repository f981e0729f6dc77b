// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/methods/method_input.h"
#include "nlos/reconstruction/reconstruct_settings.h"

namespace nlos {

/// Statistical reconstruction of any scan of any wall: the albedo f >= 0 that minimises
///
///     -log likelihood(histograms | A f + background) + tv |grad f|_1 + sparsity |f|_1
///
/// over the observed bins, A the PairOperator, by expectation maximisation with a step of total
/// variation after each pass. The pairs are taken in subsets that grow from pass to pass until all
/// of them are one, so that the last passes minimise the sum itself. Voxels that hold nothing are
/// left out from pass to pass.
///
/// Radiance is taken for counts whose brightest bin holds 400, as if the model erred there by 5 %;
/// what is negative in it counts as 0.
///
/// returns   albedo per metre of depth, see albedo_density_of_light(); not negative
/// throws    core::Failure when asked to stop
/// source    [Sawatzky2008], [Hudson1994]
Volume solve_pairs(const MethodInput& input, const ReconstructSettings& settings);

/// Memory that solve_pairs() takes on top of its input [bytes].
double solve_pairs_bytes(const MethodInput& input);

}  // namespace nlos
