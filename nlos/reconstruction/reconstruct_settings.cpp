// SPDX-License-Identifier: MIT
#include "nlos/reconstruction/reconstruct_settings.h"

#include "renderer/core/settings/settings_json.h"

#include <fmt/format.h>

#include <cmath>

namespace nlos {

void read_value(const core::Json& json, const std::string& where, SetupSettings& settings) {
    settings.is_none = json == "none";
    if (settings.is_none) return;
    if (!json.is_object()) {
        throw core::Error(where,
                          "found " + json.dump(),
                          "must be none, or an object with time_zero_sigma_ps, wall_scale_sigma or "
                          "spot_sigma_m; `nlos calibrate` measures a set-up");
    }
    core::read_value<SetupSettings>(json, where, settings);
}

core::Json write_value(const SetupSettings& settings) {
    return settings.is_none ? core::Json("none") : core::write_value<SetupSettings>(settings);
}

void validate(const ReconstructSettings& settings) {
    core::check_ranges(settings, "");
    core::check_ranges(settings.volume, "volume");
    core::check_ranges(settings.phasor, "phasor");
    core::check_ranges(settings.solver, "solver");
    core::check_ranges(settings.setup, "setup");
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
