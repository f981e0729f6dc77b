// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/methods/method_input.h"
#include "nlos/reconstruction/reconstruct_settings.h"

namespace nlos {

/// Directional light-cone transform: albedo and normals of the hidden surface. The light from a
/// surface of normal n is taken as rho (n . d) / r^gamma, d pointing from the wall to the surface,
/// which is linear in the field rho n: three convolutions, one per component, undone together by a
/// Wiener filter. Surfaces whose light carries further cosines come out tilted.
///
/// input     as light_cone_transform()
/// settings  snr, which must be set, and falloff, whose power is gamma
/// num_slabs as light_cone_transform()
/// returns   |rho n| per metre of depth, up to a common factor, 0 where it faces away from the
///           wall; a normal towards the wall for each column, at its brightest voxel
/// throws    core::Failure when asked to stop
/// source    [Young2020]
Volume directional_light_cone_transform(const MethodInput& input,
                                        const ReconstructSettings& settings,
                                        std::size_t num_slabs = 1);

/// Memory that directional_light_cone_transform() takes on top of its input [bytes].
double directional_light_cone_transform_bytes(const MethodInput& input,
                                              const ReconstructSettings& settings,
                                              std::size_t num_slabs = 1);

}  // namespace nlos
