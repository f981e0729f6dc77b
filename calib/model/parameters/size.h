// SPDX-License-Identifier: MIT
#pragma once

#include "calib/model/parameter.h"

namespace calib {

/// Relative to the model's.
inline const Parameter kSize{
    .name = "size",
    .owner = Owner::Body,
    .effect = Effect::Scales,
    .is_logarithm = true,
    .key = "size",
    .storage = [](SceneState& state,
                  std::size_t body) { return std::span<double>(&state.bodies[body].log_size, 1); },
    .move_facet =
        [](const FacetPosition& at, FacetMotion& motion) {
            const auto& [a, b, c] = motion.corners;
            motion.add(at.column,
                       {a - at.state.position_m, b - at.state.position_m, c - at.state.position_m});
        }};

}  // namespace calib
