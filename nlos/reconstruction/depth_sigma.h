// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/reconstruction/column_peak.h"
#include "nlos/reconstruction/surface.h"

#include <vector>

namespace nlos {

/// Standard deviations of a surface's depths, NaN where there is no depth.
///
/// Four parts, added in squares, with fractions of the method's own (VolumeErrors):
/// * how far peaks move between one half of the photons and the other, the mean of foreground
///   columns nearby, where few that jump to another peak must not speak for all;
/// * what the method leaves without noise, a fraction of the peak's width: where light of other
///   depths blurs or skews a peak it is wide, and it is off by about as large a part of its width
///   on every surface;
/// * how far the depth lies off the plane through its neighbours, which tells the columns that went
///   wrong from those that did not;
/// * how far its neighbours lie off theirs, where a method's noise is alike in neighbours.
///
/// The first two grow with the odds that the column is none of the surface's. The fractions are
/// those that random surfaces ask for, and `nlos bench coverage` says how well they do on others.
///
/// peaks     of the volume, per column
/// surface   with depths and probabilities of the same columns
/// again     see VolumeNoise
std::vector<double> depth_sigmas(const Volume& volume,
                                 const std::vector<ColumnPeak>& peaks,
                                 const Surface& surface,
                                 const Volume& again,
                                 const VolumeErrors& errors);

}  // namespace nlos
