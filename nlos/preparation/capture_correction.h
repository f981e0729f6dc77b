// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/preparation/scatter_cells.h"
#include "renderer/core/capture/capture.h"

#include <optional>
#include <string>
#include <vector>

namespace nlos {

/// What would make a capture right if one slip had been made in describing it.
struct CaptureCorrection {
    double length_factor = 1.0;  ///< of bin width and, unless `keeps_start`, axis start
    bool keeps_start = false;    ///< the axis start stays
    double shift_m = 0.0;        ///< added to all lengths
    double wall_factor = 1.0;    ///< of the wall's extents
    std::optional<core::OplOrigin> origin = std::nullopt;
    bool swap_xy = false;
    bool flip_x = false;
    bool flip_y = false;
    bool flip_t = false;
};

/// Where the light of sampled histograms went if the correction holds.
PathGeometry corrected_geometry(const core::Capture& capture,
                                const HistogramSample& sample,
                                const CaptureCorrection& correction);

/// Whether histograms that the correction moves between points, see PathGeometry, keep all
/// distances among points, spot and devices: the data of a mirrored scene, which nothing can tell
/// from the capture's own. So it is for the flips of every confocal scan of an even grid without
/// device legs.
bool is_mirror_image(const core::Capture& capture,
                     const HistogramSample& sample,
                     const CaptureCorrection& correction);

/// Whether wrong lengths and a wrong wall are one and the same but for the size of everything: path
/// lengths from and to the wall, and all points on a flat one stretched together.
bool is_scale_free(const core::Scan& scan);

/// The single slips that could have been made, but for those of time zero, that this capture could
/// show: factors of lengths (units, one way and round trip), the wall's size, device legs, exchange
/// and reversal of axes. Factors of 1000 and those of the speed of light are listed when they bring
/// ranges into a plausible proportion to the wall.
std::vector<CaptureCorrection> possible_corrections(const core::Capture& capture,
                                                    const HistogramSample& sample);

/// Whether the sample's ranges are in a plausible proportion to the wall: hidden scenes stand
/// between 1/30 of the wall's extent and 30 times that away. Much nearer, each point sees a scene
/// of its own; much farther, all see the same.
bool is_in_proportion(const core::Capture& capture,
                      const HistogramSample& sample,
                      const CaptureCorrection& correction);

/// The slip and its remedy for people, as `lengths look 1000 times too long, as if ps had been
/// taken for ns: --set capture.bin_width_m=0.0012`.
std::string describe_slip(const core::Capture& capture, const CaptureCorrection& correction);

}  // namespace nlos
