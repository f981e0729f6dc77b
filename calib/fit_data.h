// SPDX-License-Identifier: MIT
#pragma once

#include "calib/fit_objective.h"
#include "renderer/core/capture.h"

#include <array>
#include <optional>

namespace calib {

/// The part of a capture's histograms whose bins lie in a window of path lengths.
FitData crop(const core::Capture& capture, const std::optional<std::array<double, 2>>& window_m);

/// Data blurred by a Gaussian and summed to wider bins.
///
/// blur_m    standard deviation in path length; 0: none
/// merged    bins that become one; a rest at the end is left out
FitData coarsen(const FitData& data, double blur_m, int merged);

/// True when every value is a whole number that is not negative.
bool is_integer_valued(const core::Capture& capture);

/// Light per bin where there is least of it: a first guess of the ambient light.
double quietest_level(const FitData& data);

}  // namespace calib
