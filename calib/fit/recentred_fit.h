// SPDX-License-Identifier: MIT
#pragma once

#include "calib/fit/fit_result.h"

#include <optional>

namespace calib {

/// By how much a capture and its model have to be moved to the world's origin, where steps and
/// tolerances of solvers are small beside the world's size [m]; nothing where they are near it.
std::optional<core::Vec3> way_to_origin(const FitInput& input);

/// The same elsewhere: capture, model and start moved by `way` [m].
FitInput moved(FitInput input, const core::Vec3& way);

/// Moves what was fitted.
void move(FittedValues& values, const core::Vec3& way);

}  // namespace calib
