// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/reconstruction/reconstruction.h"

#include <string>

namespace apps {

/// The fraction of the brightest voxel from which on a column counts as surface, as the field does.
inline constexpr double kPeakFraction = 0.2;

/// The depth of every column's brightest voxel, between voxels by a parabola (see find_peak()), the
/// same for every method whatever it says itself of its surface.
///
/// returns   NaN in columns that stay below kPeakFraction
core::DepthMap peak_depths(const nlos::Volume& volume);

/// The volume that a peer wrote: `volume` (X, Y, Z), and `z_m` where its depths are its own.
///
/// asked     the axes that it was asked for
/// throws    core::Error when the file is damaged, has another shape, or depths that are not evenly
///           spaced
nlos::Volume read_peer_volume(const std::string& path, const nlos::VolumeAxes& asked);

}  // namespace apps
