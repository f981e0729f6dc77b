// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"

#include <cstddef>
#include <map>
#include <vector>

namespace core {

/// Bins of some pairs, ascending.
using MaskedBins = std::map<std::size_t, std::vector<int>>;

/// Leaves bins out of all histograms by path length. Those at either end of what a pair observed,
/// all of them of a dead point, count as not observed. Those between others hold what lies on the
/// line between their neighbours, whole photons of counts: ranges of observed bins have no holes,
/// and transforms need a value.
void leave_out_bins(const MaskedBins& masked, Capture& capture);

}  // namespace core
