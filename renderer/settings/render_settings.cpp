// SPDX-License-Identifier: MIT
#include "renderer/settings/render_settings.h"

#include <fmt/core.h>

namespace renderer {
namespace {

void require(bool holds,
             const std::string& where,
             const std::string& found,
             const std::string& allowed) {
    if (!holds) throw core::Error(where, "found " + found, "must be " + allowed);
}

void validate_restir(const RenderSettings& settings, const std::string& where) {
    const RestirSettings& restir = settings.restir;
    const auto at_least = [&](const char* key, int value, int least) {
        require(value >= least,
                fmt::format("{}.restir.{}", where, key),
                fmt::format("{}", value),
                fmt::format("at least {}", least));
    };
    at_least("walks", restir.walks, 1);
    at_least("shared_walks", restir.shared_walks, 1);
    at_least("rounds", restir.rounds, 0);
    at_least("neighbours", restir.neighbours, 0);
    at_least("confidence_cap", restir.confidence_cap, 1);
    // Shifted walks do not reach all paths of the gate: some must be drawn in it.
    require(restir.shrink_fraction >= 0.0 && restir.shrink_fraction < 1.0,
            where + ".restir.shrink_fraction",
            fmt::format("{}", restir.shrink_fraction),
            "at least 0 and below 1");
    if (settings.method != Estimator::Restir) return;
    require(settings.max_bounces <= kMaxRestirBounces,
            where + ".max_bounces",
            fmt::format("{} for method restir", settings.max_bounces),
            fmt::format("at most {}", kMaxRestirBounces));
    require(!settings.by_order,
            where + ".by_order",
            "true for method restir, whose reservoirs hold paths of all orders",
            "false; method path tells orders apart");
}

}  // namespace

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
    validate_restir(settings, where);
    if (!(settings.laser_spot_m2 > 0.0)) {
        throw core::Error(where + ".laser_spot_m2",
                          fmt::format("found {}", settings.laser_spot_m2),
                          "must be above 0");
    }
}

}  // namespace renderer
