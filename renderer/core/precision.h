// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"

namespace core {

/// Whether single precision may move a place by more than a micrometre.
inline bool needs_double(const Vec3& position) {
    constexpr double kWithinAMicrometre_m = 16.0;  // 2^-24 of it are 0.95 micrometres
    return position.cwiseAbs().maxCoeff() > kWithinAMicrometre_m;
}

}  // namespace core
