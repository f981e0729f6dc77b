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
    const EstimatorTraits& method = traits_of(settings.method);
    const auto require = [&](bool can, const char* key, const std::string& found, auto allowed) {
        core::require(
            can, where + "." + key, fmt::format("{} for method {}", found, method.name), allowed);
    };
    require(settings.max_bounces <= method.max_bounces,
            "max_bounces",
            fmt::format("{}", settings.max_bounces),
            fmt::format("at most {}, or the method {}",
                        method.max_bounces,
                        estimators_that([&](const EstimatorTraits& other) {
                            return other.max_bounces >= settings.max_bounces;
                        })));
    require(settings.gate == GateShape::Box || method.renders_shaped_gates,
            "gate",
            std::string(core::enum_name(settings.gate)),
            "box, or the method " + estimators_that(&EstimatorTraits::renders_shaped_gates));
    require(!settings.by_order || method.tells_orders_apart,
            "by_order",
            "true",
            "false, or the method " + estimators_that(&EstimatorTraits::tells_orders_apart));
}

}  // namespace renderer
