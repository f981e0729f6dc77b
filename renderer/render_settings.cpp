// SPDX-License-Identifier: MIT
#include "renderer/render_settings.h"

#include <fmt/core.h>

namespace renderer {

void validate(const RenderSettings& settings, const std::string& where) {
    if (settings.max_bounces < 1) {
        throw core::Error(where + ".max_bounces",
                          fmt::format("found {}", settings.max_bounces),
                          "must be at least 1");
    }
    if (settings.method == Estimator::ThirdBounce && settings.max_bounces > 3) {
        throw core::Error(where + ".max_bounces",
                          fmt::format("found {} for method third_bounce", settings.max_bounces),
                          "must be at most 3; method auto adds paths for higher orders");
    }
    if (settings.method == Estimator::ThirdBounce && settings.gate != GateShape::Box) {
        throw core::Error(
            where + ".gate",
            fmt::format("found {} for method third_bounce", core::enum_name(settings.gate)),
            "must be box; methods auto and path know the others");
    }
    if (settings.samples < 1) {
        throw core::Error(
            where + ".samples", fmt::format("found {}", settings.samples), "must be at least 1");
    }
    if (settings.seconds && !(*settings.seconds > 0.0)) {
        throw core::Error(
            where + ".seconds", fmt::format("found {}", *settings.seconds), "must be above 0");
    }
    if (settings.target_error && !(*settings.target_error > 0.0)) {
        throw core::Error(where + ".target_error",
                          fmt::format("found {}", *settings.target_error),
                          "must be above 0");
    }
    if (settings.exclude_area_above_m2 && !(*settings.exclude_area_above_m2 >= 0.0)) {
        throw core::Error(where + ".exclude_area_above_m2",
                          fmt::format("found {}", *settings.exclude_area_above_m2),
                          "must be at least 0");
    }
    if (!(settings.laser_spot_m2 > 0.0)) {
        throw core::Error(where + ".laser_spot_m2",
                          fmt::format("found {}", settings.laser_spot_m2),
                          "must be above 0");
    }
}

}  // namespace renderer
