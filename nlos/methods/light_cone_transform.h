// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/methods/method_input.h"
#include "nlos/reconstruction/reconstruct_settings.h"

#include <cstdint>

namespace nlos {

/// Light-cone transform: with v = (path length / 2)^2 a confocal scan of a plane is a convolution
/// of the hidden albedo, undone by a Wiener filter in the frequency domain.
///
/// Depths between voxel edges are kept by moving bin contents by overlap; cosines are not modelled;
/// negative albedo is set to zero.
///
/// input     confocal scan with input.wall.grid; x and y of input.axes at the grid's points
/// settings  falloff and snr, which must be set
/// num_slabs of frequencies, worked on one after the other: the result is the same up to rounding,
///           memory shrinks, and the transforms along time are repeated for each
/// returns   albedo per metre of depth, up to a common factor
/// throws    core::Failure when asked to stop
/// source    [OToole2018]
Volume light_cone_transform(const MethodInput& input,
                            const ReconstructSettings& settings,
                            std::size_t num_slabs = 1);

/// Memory that light_cone_transform() takes on top of its input, its volume included [bytes].
double light_cone_transform_bytes(const MethodInput& input,
                                  const ReconstructSettings& settings,
                                  std::size_t num_slabs = 1);

}  // namespace nlos
