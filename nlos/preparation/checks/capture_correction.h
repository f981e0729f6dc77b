// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/preparation/checks/scatter_cells.h"
#include "renderer/core/capture/capture.h"

#include <optional>
#include <string>
#include <vector>

namespace nlos {

/// What would make a capture right if one mistake had been made in describing it.
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
/// device segments.
bool is_mirror_image(const core::Capture& capture,
                     const HistogramSample& sample,
                     const CaptureCorrection& correction);

/// Whether wrong lengths and a wrong wall are one and the same but for the size of everything: path
/// lengths from and to the wall, and all points on a flat one stretched together.
bool is_scale_free(const core::WallScan& scan);

/// The single mistakes that could have been made, but for those of time zero, that this capture
/// could show: factors of lengths (units, one way and round trip), the wall's size, device
/// segments, exchange and reversal of axes. Units of lengths and of the wall's points are listed
/// when they bring ranges into a plausible proportion to the wall.
std::vector<CaptureCorrection> possible_corrections(const core::Capture& capture,
                                                    const HistogramSample& sample);

/// Whether the sample's ranges are in a plausible proportion to the wall: hidden scenes stand
/// between 1/30 of the wall's extent and 30 times that away. Much nearer, each point sees a scene
/// of its own; much farther, all see the same.
bool is_in_proportion(const core::Capture& capture,
                      const HistogramSample& sample,
                      const CaptureCorrection& correction);

/// The mistake and its remedy for people, as `lengths look 1000 times too long, as if ps had been
/// taken for ns: --set capture.bin_width_m=0.0012`.
std::string describe_mistake(const core::Capture& capture, const CaptureCorrection& correction);

/// How well a correction explains a capture.
struct CorrectionFit {
    CaptureCorrection correction;
    double unexplained = 1.0;  ///< see unexplained_fraction()
    bool is_seen = false;      ///< a brief direct return out of place shows it
};

/// A capture as it is described, and the best of all that may have been meant.
struct MistakeEvidence {
    double given =
        1.0;  ///< unexplained fraction of the description; 1 where it is out of proportion
    std::vector<CorrectionFit> corrections;  ///< all that were tried
};

/// Compares what a capture says of itself with single mistakes in saying it.
///
/// ambient   background per bin of every pair
/// returns   nothing for captures that cannot tell: fewer than 25 pairs, no light, histograms that
///           are alike
/// throws    nothing
std::optional<MistakeEvidence> mistake_evidence(const core::Capture& capture,
                                                const std::vector<double>& ambient);

/// The mistake that a direct return shows, unless the rest of the light speaks against it; and
/// those that explain a capture decisively better than its description, which explains it badly. At
/// most two, the better one first; empty when there is none.
std::vector<CaptureCorrection> recognise_mistakes(const MistakeEvidence& evidence);

}  // namespace nlos
