// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/preparation/prepared_capture.h"
#include "nlos/reconstruction/reconstruct_settings.h"

#include <string>

namespace nlos {

/// A method and why it was taken.
struct MethodChoice {
    Method method = Method::Bp;
    std::string reason;
};

/// Chooses the method for `auto`, or checks that the one set can serve. Single and exhaustive
/// measurements are converted in place when a confocal method was asked for.
///
/// throws   core::Error when the method set cannot serve; names one that can
MethodChoice choose_method(const ReconstructSettings& settings, PreparedCapture& prepared);

/// Fewest bins from which frequency-domain methods make sense.
inline constexpr int kMinBins = 8;

}  // namespace nlos
