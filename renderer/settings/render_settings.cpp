// SPDX-License-Identifier: MIT
#include "renderer/settings/render_settings.h"

#include <fmt/core.h>

namespace renderer {

void validate(const RenderSettings& settings, const std::string& where) {
    core::check_ranges(settings, where);
    core::check_ranges(settings.restir, where + ".restir");
    if (settings.element_tolerance && (settings.target_error || settings.seconds)) {
        throw core::Error(where + ".element_tolerance",
                          "found beside target_error or seconds",
                          "must stand instead of them");
    }
    if (settings.method == Estimator::ThirdBounce) {
        core::require(settings.max_bounces <= 3,
                      where + ".max_bounces",
                      fmt::format("{} for method third_bounce", settings.max_bounces),
                      "at most 3; method auto adds paths for higher orders");
        core::require(settings.gate == GateShape::Box,
                      where + ".gate",
                      fmt::format("{} for method third_bounce", core::enum_name(settings.gate)),
                      "box; methods auto and path know the others");
    }
    if (settings.method == Estimator::Restir) {
        core::require(settings.max_bounces <= kMaxRestirBounces,
                      where + ".max_bounces",
                      fmt::format("{} for method restir", settings.max_bounces),
                      fmt::format("at most {}", kMaxRestirBounces));
        core::require(!settings.by_order,
                      where + ".by_order",
                      "true for method restir, whose reservoirs hold paths of all orders",
                      "false; method path tells orders apart");
    }
}

}  // namespace renderer
