// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/methods/methods.h"

namespace nlos {

/// Columns at the scan's points or evenly over its footprint, depths at the bins' ranges.
///
/// axis       of prepared histograms
/// settings   with the method and a range of depths; takes the number of voxels
VolumeAxes choose_axes(const PreparedCapture& prepared,
                       const core::TimeAxis& axis,
                       ReconstructSettings& settings);

}  // namespace nlos
