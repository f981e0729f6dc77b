// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/methods/method_input.h"
#include "nlos/preparation/prepared_capture.h"
#include "nlos/reconstruction/reconstruct_settings.h"

#include <optional>
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

/// What a method that works by transforms makes of bins that were not observed, for people; nothing
/// for other methods, which leave them out.
///
/// settings   whose method is chosen
/// num_bins   of a histogram
std::optional<std::string> unobserved_warning(const ReconstructSettings& settings,
                                              const core::ObservedBins& observed,
                                              int num_bins);

}  // namespace nlos
