// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"

#include <optional>

namespace nlos {

/// Histograms of a confocal scan, path lengths from and to the wall.
struct ConfocalData {
    core::WallPoints points;
    core::TimeAxis time_axis;
    core::Transient transient;
    core::ObservedBins observed;
};

/// Turns a non-confocal scan into the confocal one it resembles (normal moveout): the path
/// l -> p -> s of length tau becomes the path m -> p -> m of length sqrt(tau^2 - |l - s|^2) at the
/// midpoint m = (l + s) / 2, exact for points p equally far from l and s. Device legs are taken
/// off; pairs that share a midpoint are averaged, those alone that observed a bin where not all
/// did.
///
/// observed  bins of the pairs; of a midpoint, the longest run of bins that its pairs observed half
///           or more of
/// scan      single or exhaustive; a single-laser scan becomes one of half the pitch and aperture
/// returns   points on a grid and mean histograms; nothing when the midpoints do not fill an even
///           grid
/// throws    core::Failure when memory does not suffice, as for an axis that starts very late;
///           core::Error when such an axis has more bins than can be counted
/// source    [Lindell2019], supplement
std::optional<ConfocalData> convert_to_confocal(const core::Scan& scan,
                                                const core::TimeAxis& axis,
                                                const core::Transient& transient,
                                                const core::ObservedBins& observed = std::nullopt);

}  // namespace nlos
