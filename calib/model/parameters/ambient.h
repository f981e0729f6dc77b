// SPDX-License-Identifier: MIT
#pragma once

#include "calib/model/parameter.h"

namespace calib {

/// Per bin of the capture, in the data's unit; none where it is not free.
inline const Parameter kAmbient{.name = "ambient",
                                .owner = Owner::Scene,
                                .effect = Effect::AddsLight,
                                .is_logarithm = true,
                                .fixed = -std::numeric_limits<double>::infinity(),
                                .key = "ambient"};

}  // namespace calib
