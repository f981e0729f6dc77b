// SPDX-License-Identifier: MIT
#include "renderer/core/velocity_axis.h"

#include <fmt/core.h>

#include <cmath>

namespace core {
namespace {

void require_positive(double value, const std::string& where) {
    if (value > 0.0 && std::isfinite(value)) return;
    throw Error(where, fmt::format("found {}", value), "must be above 0 and finite");
}

}  // namespace

void validate(const VelocityAxis& axis, const std::string& where) {
    if (axis.num_bins < 1) {
        throw Error(
            where + ".num_bins", fmt::format("found {}", axis.num_bins), "must be at least 1");
    }
    if (!std::isfinite(axis.start_m_per_s)) {
        throw Error(where + ".start_m_per_s",
                    fmt::format("found {}", axis.start_m_per_s),
                    "must be finite");
    }
    require_positive(axis.bin_width_m_per_s, where + ".bin_width_m_per_s");
    require_positive(axis.carrier_hz, where + ".carrier_hz");
}

}  // namespace core
