// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/settings.h"

#include <array>
#include <functional>
#include <limits>
#include <string>
#include <string_view>

namespace renderer {

/// Which estimator computes the transient. How each renders stands in renderer/estimators.cpp.
enum class Estimator { Auto, Path, ThirdBounce, Ellipsoidal, Restir };

/// What an estimator can be asked for. Callers ask these facts, never for the name.
struct EstimatorTraits {
    std::string_view name;
    int max_bounces = std::numeric_limits<int>::max();
    bool tells_orders_apart = true;
    bool renders_shaped_gates = true;
    bool renders_velocities = true;
    bool renders_images = true;
    bool renders_sensors = true;
    bool renders_all_surfaces = true;    ///< also narrow lobes
    bool has_independent_frames = true;  ///< of a sequence: each may reach any error
    bool integrates = false;             ///< what it can, by elements whose size has a tolerance
    bool is_deterministic = false;       ///< no seed nor number of samples changes the result
    bool excludes_surfaces = false;      ///< from connections, as the settings `exclude*` say
};

/// One row for each enumerator, in their order.
inline constexpr std::array kEstimators{
    EstimatorTraits{.name = "auto", .integrates = true},
    EstimatorTraits{.name = "path"},
    EstimatorTraits{.name = "third_bounce",
                    .max_bounces = 3,
                    .renders_shaped_gates = false,
                    .renders_velocities = false,
                    .renders_images = false,
                    .renders_all_surfaces = false,
                    .integrates = true,
                    .is_deterministic = true},
    EstimatorTraits{.name = "ellipsoidal", .excludes_surfaces = true},
    EstimatorTraits{.name = "restir",
                    .max_bounces = 9,  // what a reservoir stores
                    .tells_orders_apart = false,
                    .renders_sensors = false,
                    .has_independent_frames = false,
                    .excludes_surfaces = true},
};

constexpr const EstimatorTraits& traits_of(Estimator estimator) {
    return kEstimators[static_cast<std::size_t>(estimator)];
}

/// The names of the estimators that have a trait or satisfy a condition, as in "auto, path or
/// restir".
template <class Trait>
std::string estimators_that(const Trait& trait) {
    std::string names;
    std::string_view last;
    for (const EstimatorTraits& traits : kEstimators) {
        if (!std::invoke(trait, traits)) continue;
        if (!last.empty()) names += (names.empty() ? "" : ", ") + std::string(last);
        last = traits.name;
    }
    return names.empty() ? std::string(last) : names + " or " + std::string(last);
}

}  // namespace renderer

template <>
struct core::EnumNames<renderer::Estimator> {
    static constexpr auto value = [] {
        std::array<std::pair<renderer::Estimator, std::string_view>, renderer::kEstimators.size()>
            names;
        for (std::size_t i = 0; i < names.size(); ++i) {
            names[i] = {static_cast<renderer::Estimator>(i), renderer::kEstimators[i].name};
        }
        return names;
    }();
};
