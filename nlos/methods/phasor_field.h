// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/methods/method_input.h"
#include "nlos/reconstruction/reconstruct_settings.h"

namespace nlos {

/// Phasor field: the relay wall as the lens of a camera for a virtual wave that illuminates the
/// hidden scene from the illumination points. The field at a voxel is
///
///     sum over pairs of (H * wave)(|l - p| + |p - s|),
///
/// the wave focused at the moment it reaches the voxel. On planar sensing grids it is propagated
/// frequency by frequency with the Rayleigh-Sommerfeld kernel by FFT from plane to plane, a group
/// of planes at a time: how many frequencies that takes grows with the span of their path lengths.
/// Amplitude factors of the propagation are left out.
///
/// input      any scan
/// settings   phasor; its wavelength_m must be set
/// num_slabs  parts of the frequencies that are propagated one after another
/// returns    magnitude of the field
/// throws     core::Failure when asked to stop
/// source     [Liu2019], [Liu2020]
Volume phasor_field(const MethodInput& input,
                    const ReconstructSettings& settings,
                    std::size_t num_slabs = 1);

/// How much phasor_field() transforms laterally on a planar grid, per illumination point.
struct PhasorTransforms {
    std::size_t wall = 0;              ///< frequencies at the wall
    std::size_t planes = 0;            ///< frequencies at planes of voxels
    std::size_t most_frequencies = 0;  ///< that serve one plane
};
PhasorTransforms phasor_transforms(const MethodInput& input, const PhasorSettings& settings);

/// Memory that phasor_field() takes on top of its input, its volume included [bytes].
double phasor_field_bytes(const MethodInput& input,
                          const ReconstructSettings& settings,
                          std::size_t num_slabs = 1);

}  // namespace nlos
