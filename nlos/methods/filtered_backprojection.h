// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/methods/method_input.h"
#include "nlos/reconstruction/reconstruct_settings.h"

namespace nlos {

/// Backprojection sharpened by the negative Laplacian of a Gaussian of 1 voxel, cut to 5 voxels
/// along each axis. Linear in the histograms; surfaces are positive with negative surroundings.
///
/// settings    compensation
/// num_slabs   as backproject()
/// source      [Velten2012]
Volume laplacian_backprojection(const MethodInput& input,
                                const ReconstructSettings& settings,
                                std::size_t num_slabs = 1);

/// Magnitude of the backprojection of histograms convolved with the phasor field's virtual wave,
/// and divided by the observed share as in backproject().
///
/// settings    phasor; its wavelength_m must be set
/// num_slabs   as backproject()
/// source      [Liu2019]
Volume phasor_backprojection(const MethodInput& input,
                             const ReconstructSettings& settings,
                             std::size_t num_slabs = 1);

/// Memory on top of the input, the volume included [bytes].
double laplacian_backprojection_bytes(const MethodInput& input,
                                      const ReconstructSettings& settings,
                                      std::size_t num_slabs = 1);
double phasor_backprojection_bytes(const MethodInput& input,
                                   const ReconstructSettings& settings,
                                   std::size_t num_slabs = 1);

}  // namespace nlos
