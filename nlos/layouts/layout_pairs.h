// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/layouts/layout_histograms.h"

namespace nlos {

/// Whether two lists hold the same points up to the single precision of files.
bool are_same_points(const core::WallPoints& a, const core::WallPoints& b);

/// Where the points are and how they pair up.
///
/// scan      its origin of path lengths and its devices are known; gets points and pattern
/// throws    core::Error when arrays are missing or do not fit the histograms, or when these do not
///           hold every pair of the pattern once
PairNumbers read_pairs(const LayoutFiles& files,
                       const Layout& layout,
                       const HistogramArray& array,
                       const CaptureReadSettings& settings,
                       core::Scan& scan);

}  // namespace nlos
