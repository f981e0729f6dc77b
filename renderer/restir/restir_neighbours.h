// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/scan.h"
#include "renderer/core/random.h"

#include <cstddef>
#include <vector>

namespace renderer {

/// Which pairs are near each other: pixels by position in the image, wall points by distance, so
/// that scans need not be grids.
class RestirNeighbours {
 public:
    /// scan   of which the pairs are
    explicit RestirNeighbours(const core::Scan& scan);

    /// Picks different pairs near a pair at random, fewer where there are not as many.
    void pick(std::size_t pair, int count, core::Rng& rng, std::vector<std::size_t>& picked) const;

 private:
    void list(const core::WallScan& scan, std::size_t pair, std::vector<std::size_t>& near) const;
    void list(const core::ImageScan& image,
              std::size_t pixel,
              std::vector<std::size_t>& near) const;

    core::Scan scan_;
    std::size_t near_sensing_count_ = 0;  ///< per point
    std::size_t near_illumination_count_ = 0;
    std::vector<std::size_t> near_sensing_;       ///< (points, count)
    std::vector<std::size_t> near_illumination_;  ///< likewise; empty unless exhaustive
};

}  // namespace renderer
