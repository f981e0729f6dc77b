// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/reconstruction/column_peak.h"
#include "nlos/reconstruction/surface.h"
#include "nlos/reconstruction/volume_noise.h"

#include <vector>

namespace nlos {

/// Standard deviations of a surface's depths, NaN where there is no depth.
///
/// A peak of brightness v and curvature v'' moves by n'/v'' under noise of slope n'. That slope's
/// deviation is told from how far peaks move between volumes of the same scene, pooled over
/// foreground columns nearby; it stands relative to the noise's deviation at that depth, which
/// falloff raises. What the method leaves of its own is added in squares. Where a column may be
/// none of the surface's, depths are worse than either says: the sum is multiplied by a factor of
/// the odds. How far a depth lies off the plane through its neighbours tells the columns that went
/// wrong from those that did not; its share is added in squares, too. The shares are those that
/// random surfaces ask for, and `nlos bench coverage` says how well they do on others.
///
/// peaks     of the volume, per column
/// surface   with depths and probabilities of the same columns
/// again     see VolumeNoise
std::vector<double> depth_sigmas(const Volume& volume,
                                 const std::vector<ColumnPeak>& peaks,
                                 const Surface& surface,
                                 const Volume& again,
                                 const VolumeErrors& errors,
                                 const VolumeNoise& noise);

}  // namespace nlos
