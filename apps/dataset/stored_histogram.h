// SPDX-License-Identifier: MIT
#pragma once

#include "apps/dataset/item.h"
#include "renderer/core/capture.h"

namespace apps {

/// Adds the histograms of a capture to an item, time slowest as in capture files. Counts beyond the
/// type are clipped and counted. Half precision comes with a factor, a power of two that makes the
/// most of its range: `NAME_scale`, by which values have to be multiplied.
void add_histograms(const std::string& name,
                    const core::Capture& capture,
                    HistogramStorage storage,
                    Item& item);

}  // namespace apps
