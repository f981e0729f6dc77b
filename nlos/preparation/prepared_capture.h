// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/preparation/wall_frame.h"
#include "nlos/reconstruction/reconstruct_settings.h"
#include "renderer/core/capture/capture.h"

#include <string>

namespace nlos {

/// What a method reconstructs from: a capture, or what cropping and conversion made of it.
struct PreparedCapture {
    core::Scan scan;
    core::TimeAxis time_axis;
    core::TransientUnit unit = core::TransientUnit::Radiance;
    core::Transient own;  ///< histograms that differ from the capture's; else empty
    const core::Transient* capture_transient = nullptr;
    core::ObservedBins observed;       ///< of transient()
    double unobserved_before_m = 0.0;  ///< path length cut off before the axis: nobody looked there
    WallFrame wall;
    std::string conversion;  ///< in words, when the scan was converted

    double own_bytes() const { return 4.0 * static_cast<double>(own.values().size()); }
    const core::Transient& transient() const { return own.empty() ? *capture_transient : own; }
};

/// The part of a capture that `crop` leaves, without bins that no pair observed at either end of
/// the axis. A scan of many illumination points and one sensing
/// point becomes the single-laser scan that it equals by reciprocity.
///
/// capture   must outlive the result
/// throws    core::Error when nothing is left or observed; core::Failure when memory does not
/// suffice
PreparedCapture crop_capture(const core::Capture& capture, const CropSettings& crop);

/// Converts a single or exhaustive measurement to the confocal one it resembles.
///
/// returns   false when its midpoints do not fill an even grid; `prepared` is then unchanged
/// throws    core::Failure when memory does not suffice
bool convert_to_confocal(PreparedCapture& prepared);

}  // namespace nlos
