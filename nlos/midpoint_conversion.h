// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture.h"

#include <optional>

namespace nlos {

/// Turns a non-confocal capture into the confocal one it resembles (normal moveout): the path
/// l -> p -> s of length tau becomes the path m -> p -> m of length sqrt(tau^2 - |l - s|^2) at the
/// midpoint m = (l + s) / 2, exact for points p equally far from l and s. Device legs are taken
/// off; pairs that share a midpoint are averaged.
///
/// capture   single or exhaustive; a single-laser scan becomes one of half the pitch and aperture
/// returns   a confocal capture on a grid, of mean histograms; nothing when the midpoints do not
///           fill an even grid
/// throws    nothing
/// source    [Lindell2019], supplement
std::optional<core::Capture> convert_to_confocal(const core::Capture& capture);

}  // namespace nlos
