// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/shift/shift_counts.h"

#include <cstdint>

namespace renderer {

/// What happened while paths were resampled.
struct RestirCounts {
    std::uint64_t num_rays = 0;
    std::uint64_t num_merges = 0;  ///< of two reservoirs
    ShiftCounts shifts;

    RestirCounts& operator+=(const RestirCounts& other) {
        num_rays += other.num_rays;
        num_merges += other.num_merges;
        shifts += other.shifts;
        return *this;
    }
};

}  // namespace renderer
