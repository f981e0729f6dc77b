// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/preparation/capture_correction.h"

#include <optional>
#include <vector>

namespace nlos {

/// How well a correction explains a capture.
struct CorrectionShare {
    CaptureCorrection correction;
    double unexplained = 1.0;  ///< see unexplained_share()
    bool is_seen = false;      ///< a brief direct return out of place shows it
};

/// A capture as it is described, and the best of all that may have been meant.
struct SlipEvidence {
    double given = 1.0;  ///< unexplained share of the description; 1 where it is out of proportion
    std::vector<CorrectionShare> corrections;  ///< all that were tried
};

/// Compares what a capture says of itself with single slips in saying it.
///
/// ambient   background per bin of every pair
/// returns   nothing for captures that cannot tell: fewer than 25 pairs, no light, histograms that
///           are alike
/// throws    nothing
std::optional<SlipEvidence> slip_evidence(const core::Capture& capture,
                                          const std::vector<double>& ambient);

/// The slip that a direct return shows, unless the rest of the light speaks against it; and those
/// that explain a capture decisively better than its description, which explains it badly. At most
/// two, the better one first; empty when there is none.
std::vector<CaptureCorrection> recognise_slips(const SlipEvidence& evidence);

}  // namespace nlos
