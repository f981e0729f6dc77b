// SPDX-License-Identifier: MIT
#pragma once

#include "calib/model/parameter.h"

namespace calib {

/// Data per model radiance: free where the data's unit leaves it open.
inline const Parameter kScale{.name = "scale",
                              .owner = Owner::Scene,
                              .effect = Effect::Multiplies,
                              .is_setting = false,
                              .is_logarithm = true,
                              .key = "scale"};

}  // namespace calib
