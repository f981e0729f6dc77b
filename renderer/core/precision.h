// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"

namespace core {

/// Whether single precision moves a place by more than a micrometre: beyond 16 m or so.
inline bool needs_double(const Vec3& position) {
    constexpr double kNotable_m = 1e-6;
    const Vec3 single = position.cast<float>().cast<double>();
    return (position - single).cwiseAbs().maxCoeff() > kNotable_m;
}

}  // namespace core
