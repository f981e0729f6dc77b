// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/reconstruction/column_peak.h"
#include "nlos/reconstruction/volume_noise.h"
#include "renderer/core/depth_map.h"

#include <vector>

namespace nlos {

/// Standard deviations of a volume's depths, NaN where there is no depth.
///
/// A peak of brightness v and curvature v'' moves by n'/v'' under noise of slope n'. That slope's
/// deviation is told from how far the peaks have moved in a volume of the same scene measured
/// again, pooled over foreground columns nearby; it stands relative to the noise's deviation at
/// that depth, which falloff raises. What the method itself and the grid leave is added: 0.35 of a
/// voxel, found on simulated scenes, see nlos/README.md.
///
/// peaks    of the volume, per column
/// depth    of the same columns
/// again    see VolumeNoise
std::vector<double> depth_sigmas(const Volume& volume,
                                 const std::vector<ColumnPeak>& peaks,
                                 const core::DepthMap& depth,
                                 const Volume& again,
                                 VolumeScale scale,
                                 const VolumeNoise& noise);

}  // namespace nlos
