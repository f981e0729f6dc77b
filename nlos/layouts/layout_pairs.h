// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/layouts/layout_histograms.h"

namespace nlos {

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
