// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"

#include <string>
#include <vector>

namespace nlos {

// Stanford's confocal files ([OToole2018], [Lindell2019]) hold a square of wall points: z = 0
// around the origin, ends included, x ascending along one axis and y descending along the other.

/// What we add to files that we write: start of the axis, bin width, 0 for radiance or 1 for
/// counts, and counts per radiance or 0.
inline constexpr const char* kOwnAxis = "nlos_axis";

/// The points of such a square, x slowest.
core::WallPoints stanford_points(std::size_t count, double half_width_m);

/// How a scan's pairs stand in such a square.
struct StanfordScan {
    double half_width_m = 0.0;
    std::size_t side = 0;
    bool y_ascends = true;

    /// The pair at index i along x and j along -y.
    std::size_t pair(std::size_t i, std::size_t j) const {
        return i * side + (y_ascends ? side - 1 - j : j);
    }
};

/// Throws core::Error that names `path` unless the scan is such a square, whose path lengths
/// exclude the legs to the devices.
StanfordScan stanford_scan(const std::string& path, const core::Scan& scan);

}  // namespace nlos
