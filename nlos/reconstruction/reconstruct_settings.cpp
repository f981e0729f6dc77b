// SPDX-License-Identifier: MIT
#include "nlos/reconstruction/reconstruct_settings.h"

#include <fmt/format.h>

#include <cmath>

namespace nlos {

void validate(const ReconstructSettings& settings) {
    core::check_ranges(settings, "");
    core::check_ranges(settings.volume, "volume");
    core::check_ranges(settings.phasor, "phasor");
    core::check_ranges(settings.solver, "solver");
    if (settings.noise_floor) {
        core::require(settings.ambient != Ambient::Keep,
                      "noise_floor",
                      fmt::format("{} with ambient=keep", *settings.noise_floor),
                      "taken off with ambient=auto or subtract");
    }
    if (settings.volume.z_range_m) {
        const auto [begin, end] = *settings.volume.z_range_m;
        core::require(begin >= 0.0 && end > begin && std::isfinite(end),
                      "volume.z_range_m",
                      fmt::format("[{}, {}]", begin, end),
                      "two depths, ascending and not below 0");
    }
}

}  // namespace nlos
