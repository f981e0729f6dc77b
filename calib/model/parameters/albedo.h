// SPDX-License-Identifier: MIT
#pragma once

#include "calib/model/parameter.h"

#include <cmath>

namespace calib {

/// Of a body's first surface.
inline const Parameter kAlbedo{
    .name = "albedo",
    .owner = Owner::Body,
    .effect = Effect::Multiplies,
    .is_logarithm = true,
    .key = "albedo",
    .highest = 1.0,
    .start_body = [](const ModelBody& body,
                     bool,
                     BodyState& state) { state.numbers["albedo"] = std::log(body.albedo); },
};

}  // namespace calib
