// SPDX-License-Identifier: MIT
#include "apps/estimate_text.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace apps {

std::string estimate_text(double value, double sigma) {
    constexpr int kMostDecimals = 15;
    if (sigma == 0.0) return fmt::format("{:.6g}", value);
    if (!std::isfinite(sigma)) return fmt::format("{:.6g} (unknown)", value);
    const int decimals =
        std::clamp(1 - static_cast<int>(std::floor(std::log10(sigma))), 0, kMostDecimals);
    return fmt::format("{:.{}f} +- {:.{}f}", value, decimals, sigma, decimals);
}

}  // namespace apps
