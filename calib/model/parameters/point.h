// SPDX-License-Identifier: MIT
#pragma once

#include "calib/model/parameter.h"

#include <cmath>

namespace calib {

/// A point scatterer is free as a whole: its position and its albedo times area [m^2].
inline const Parameter kPointPosition{.name = "position",
                                      .owner = Owner::Point,
                                      .effect = Effect::Translates,
                                      .columns = {"x", "y", "z"},
                                      .storage = [](SceneState& state, std::size_t point) {
                                          return std::span<double>(
                                              state.points[point].position_m.data(), 3);
                                      }};

inline const Parameter kPointAlbedo{.name = "albedo",
                                    .owner = Owner::Point,
                                    .effect = Effect::Multiplies,
                                    .is_logarithm = true,
                                    .start = std::log(1e-3)};

}  // namespace calib
