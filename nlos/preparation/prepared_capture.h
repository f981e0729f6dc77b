// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/preparation/wall_frame.h"
#include "nlos/reconstruction/reconstruct_settings.h"
#include "renderer/core/capture/capture.h"

#include <optional>
#include <string>

namespace nlos {

/// Where half of a scan's light has come, and how well it is told from where.
struct LightResolution {
    double range_m;       ///< from the middle of the wall points, half a path length
    double resolution_m;  ///< told apart there in any direction; infinite: in none
};

/// What a method reconstructs from: a capture, or what cropping and conversion made of it.
struct PreparedCapture {
    core::WallScan scan;
    core::TimeAxis time_axis;
    core::TransientUnit unit = core::TransientUnit::Radiance;
    core::Transient own;  ///< histograms that differ from the capture's; else empty
    const core::Transient* capture_transient = nullptr;
    core::ObservedBins observed;       ///< of transient()
    double unobserved_before_m = 0.0;  ///< path length cut off before the axis: nobody looked there
    std::optional<LightResolution> light;  ///< as captured; nothing in the dark
    WallFrame wall;
    std::string conversion;  ///< in words, when the scan was converted

    double own_bytes() const { return 4.0 * static_cast<double>(own.values().size()); }
    const core::Transient& transient() const { return own.empty() ? *capture_transient : own; }
};

/// The part of a capture that `crop` leaves, without bins that no pair observed at either end of
/// the axis, on grids where its points fill some, see sort_into_grids(). A scan of many
/// illumination points and one sensing point becomes the single-laser scan that it equals by
/// reciprocity.
///
/// capture   must outlive the result
/// throws    core::Error when nothing is left or observed; core::Failure when memory does not
/// suffice
PreparedCapture crop_capture(const core::Capture& capture, const CropSettings& crop);

/// Drops bins that no pair observed at either end of the axis, of histograms of its own.
/// Throws core::Error when nothing was observed.
void drop_unobserved_ends(PreparedCapture& prepared);

/// Turns a single or exhaustive measurement into the confocal one it resembles (normal moveout):
/// the path l -> p -> s of length tau becomes the path m -> p -> m of length sqrt(tau^2 - |l -
/// s|^2) at the midpoint m = (l + s) / 2, exact for points p equally far from l and s. Device
/// segments are taken off; pairs that share a midpoint are averaged, those alone that observed a
/// bin where not all did. Of a midpoint, the longest run of bins counts as observed that its pairs
/// observed half or more of.
///
/// prepared  a single-laser scan becomes one of half the pitch and aperture
/// returns   false when its midpoints do not fill an even grid; `prepared` is then unchanged
/// throws    core::Failure when memory does not suffice, as for an axis that starts very late;
///           core::Error when such an axis has more bins than can be counted
/// source    [Lindell2019], supplement
bool convert_to_confocal(PreparedCapture& prepared);

}  // namespace nlos
