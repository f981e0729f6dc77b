// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/reconstruction/surface_probability.h"
#include "nlos/reconstruction/volume.h"
#include "nlos/reconstruction/volume_noise.h"
#include "renderer/core/depth_map.h"

#include <vector>

namespace nlos {

/// The surface that a volume shows from the wall, and how sure that is.
struct Surface {
    core::DepthMap depth;               ///< NaN = background; normals in world, zero there
    std::vector<double> probability;    ///< per column, that it holds a surface
    std::vector<double> depth_sigma_m;  ///< NaN = background; empty: the noise is not known
};

/// What a method's volume says of noise and depth.
struct VolumeErrors {
    VolumeScale scale = VolumeScale::Amplitude;
    double model_fraction = 0.0;  ///< of a peak's width: deviation of depths without noise
    double noise_fraction = 0.5;  ///< of the noise's deviation that roughness does not show
    double doubt = 0.0;           ///< how both grow with the odds against a surface
    double near_fraction = 0.0;   ///< of the neighbours' roughness
    PlateauFractions plateau = {};
    double steepest = 0.0;  ///< slope of surfaces whose light is spread over voxels of a column
    double front = 0.0;     ///< fraction of a peak from which on one before it hides it; 0: never
};

/// Finds each column's peak, how likely it is a surface, and how well its depth is known.
///
/// Without knowledge of noise the peak is the brightest voxel, and the probability is that of
/// plateau_probabilities(). With it, the peak is the brightest of what noise cannot explain, and
/// the probability that it is no noise (one minus false_discovery_rates()) is a factor. Of surfaces
/// one behind another in a column, which other wall points see past each other, depth is that of
/// the first, as far as VolumeErrors::front tells. Normals are those of planes fitted to
/// neighbouring foreground columns.
///
/// again            the volume of measure_again(), null: the noise is not known
/// mask_threshold   the probability from which on a column has a depth, in (0, 1)
/// returns          nothing is foreground in a volume without positive values
/// throws           nothing
Surface find_surface(const Volume& volume,
                     const Volume* again,
                     const VolumeErrors& errors,
                     double mask_threshold);

}  // namespace nlos
