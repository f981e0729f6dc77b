// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"

#include <algorithm>
#include <vector>

namespace renderer {

/// Which points of a scan are both ends of some pair: retroreflectors return light to these alone.
/// All points of a confocal scan are, and in other scans those that both lists hold.
struct CoincidingPoints {
    std::vector<bool> illumination;
    std::vector<bool> sensing;

    /// scan   of wall points
    explicit CoincidingPoints(const core::WallScan& scan);

    bool any() const { return std::ranges::find(sensing, true) != sensing.end(); }
};

}  // namespace renderer
