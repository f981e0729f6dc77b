// SPDX-License-Identifier: MIT
#include "renderer/core/time_axis.h"

#include <fmt/core.h>

#include <cmath>

namespace core {

void validate(const TimeAxis& axis, const std::string& where) {
    if (axis.num_bins < 1) {
        throw Error(
            where + ".num_bins", fmt::format("found {}", axis.num_bins), "must be at least 1");
    }
    if (!(axis.bin_width_m > 0.0) || !std::isfinite(axis.bin_width_m)) {
        throw Error(where + ".bin_width_m",
                    fmt::format("found {}", axis.bin_width_m),
                    "must be positive and finite [m]");
    }
    if (!std::isfinite(axis.opl_start_m)) {
        throw Error(where + ".opl_start_m",
                    fmt::format("found {}", axis.opl_start_m),
                    "must be finite [m]");
    }
}

}  // namespace core
