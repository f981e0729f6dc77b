// SPDX-License-Identifier: MIT
#pragma once

#include "calib/compare_fit.h"
#include "calib/fit.h"
#include "nlos/pictures/picture.h"

#include <vector>

namespace apps {

/// Data, model and their difference in standard deviations, a row per wall point.
std::vector<nlos::Panel> fit_panels(const calib::FitResult& result);

/// The fitted scene over the truth from the front, the side and above, in a wall's frame.
///
/// returns   nothing when there is no surface and no point to show
std::vector<nlos::Panel> overlay_panels(const calib::FitErrors& errors,
                                        const core::Transform& world_from_wall);

}  // namespace apps
