// SPDX-License-Identifier: MIT
#pragma once

#include "calib/model/parameter.h"

namespace calib {

/// Path length that the axis reads at true length 0.
inline const Parameter kTimeZero{.name = "time_zero",
                                 .owner = Owner::Scene,
                                 .effect = Effect::ShiftsTime,
                                 .key = "time_zero_m",
                                 .prior = "prior_sigma_m",
                                 .misfit = {"time zero", 1e3, "mm of path"}};

}  // namespace calib
