// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/methods/method_input.h"
#include "nlos/reconstruction/reconstruct_settings.h"

namespace nlos {

/// Light-cone transform with a prior: minimises
///
///     |K f - g|^2 / 2 + weight |grad f|_1 + sparsity |f|_1   over f >= 0,
///
/// the first norm over the observed bins of the scan's points, f vanishing outside the wall's
/// footprint, by the alternating direction method of multipliers. Data are scaled to a maximum of 1
/// and the kernel K to unit norm.
///
/// input      as light_cone_transform()
/// settings   falloff and tv
/// num_slabs  not used: every iteration needs all frequencies
/// returns    albedo per metre of depth, up to a common factor; not negative
/// throws     core::Failure when asked to stop
/// source     [OToole2018], supplement; [Boyd2011]
Volume total_variation_light_cone_transform(const MethodInput& input,
                                            const ReconstructSettings& settings,
                                            std::size_t num_slabs);

/// Memory that total_variation_light_cone_transform() takes on top of its input [bytes].
double total_variation_bytes(const MethodInput& input,
                             const ReconstructSettings& settings,
                             std::size_t num_slabs);

}  // namespace nlos
