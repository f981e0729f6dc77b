// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/settings.h"
#include "renderer/settings/estimators.h"
#include "renderer/settings/restir_settings.h"

#include <cstdint>
#include <optional>
#include <string>

namespace renderer {

/// Shape of the time gate of a one-bin axis; peak 1.
enum class GateShape { Box, Tent, Gaussian };

/// How the ellipsoidal technique treats excluded surfaces.
enum class Exclusion { None, Mis, Drop };

/// What to compute and how hard to try.
struct RenderSettings {
    Estimator method = Estimator::Auto;
    int max_bounces = 3;
    int samples = 256;
    std::optional<double> seconds;
    std::optional<double> target_error;
    std::optional<double> element_tolerance;
    std::uint64_t seed = 0;
    GateShape gate = GateShape::Box;
    Exclusion exclude = Exclusion::Mis;
    std::optional<double> exclude_area_above_m2;
    bool variance = false;
    bool by_order = false;
    bool direct_return = false;
    double laser_spot_m2 = 1e-4;
    bool dielectric_specular = false;
    RestirSettings restir;
};

template <class Visitor>
void for_each_field(RenderSettings& s, Visitor&& visit) {
    visit("method", s.method, "estimator");
    visit("max_bounces",
          s.max_bounces,
          core::at_least(1, "bounces counted, both on the relay wall included"));
    visit("samples", s.samples, core::at_least(1, "candidate paths per pair of points or pixel"));
    visit("seconds",
          s.seconds,
          core::above(0, "render for this long instead of a number of samples or an error [s]"));
    visit("target_error",
          s.target_error,
          core::above(0,
                      "relative L2 error over all of H to stay below, instead of a number of "
                      "samples; auto may then leave out orders, and average those from 4 on over "
                      "neighbouring points and bins; null: 0.01 for third_bounce"));
    visit("element_tolerance",
          s.element_tolerance,
          core::above(0,
                      "third_bounce: relative error that the size of elements aims at, instead of "
                      "an error that pilot runs estimate; spares these, and the error stays "
                      "unknown"));
    visit("seed", s.seed, "seed of the random numbers");
    visit("gate", s.gate, "shape of the gate of a one-bin axis");
    visit("exclude",
          s.exclude,
          "excluded surfaces: mis leaves them to paths, drop ignores them, none excludes nothing");
    visit(
        "exclude_area_above_m2",
        s.exclude_area_above_m2,
        core::at_least(0, "exclude triangles above this area from ellipsoidal connections [m^2]"));
    visit("variance",
          s.variance,
          "also store the variance of every value, in group /nlos, which y-tal refuses; paths "
          "then take many short passes, which are noisier than few long ones");
    visit("by_order",
          s.by_order,
          "also store the transient of every bounce order, in group /nlos too");
    visit("direct_return", s.direct_return, "render the direct return of confocal pairs, order 1");
    visit("laser_spot_m2",
          s.laser_spot_m2,
          core::above(
              0, "area of the laser spot on the wall: direct return and retroreflectors [m^2]"));
    visit("dielectric_specular",
          s.dielectric_specular,
          "give materials that are not metallic the specular reflection that glTF defines, of 4 % "
          "at normal incidence; without, they are diffuse");
    visit("restir", s.restir, "reservoir reuse");
}

/// Throws core::Error naming the setting that is out of range.
void validate(const RenderSettings& settings, const std::string& where);

}  // namespace renderer

template <>
struct core::EnumNames<renderer::GateShape> {
    static constexpr auto value = names_from_zero<renderer::GateShape>("box", "tent", "gaussian");
};
template <>
struct core::EnumNames<renderer::Exclusion> {
    static constexpr auto value = names_from_zero<renderer::Exclusion>("none", "mis", "drop");
};
