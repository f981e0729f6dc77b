// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"
#include "renderer/core/capture/instrument_response.h"

#include <optional>
#include <string>

namespace nlos {

/// What a set-up does to light, as the wall's direct return shows it, which has seen nothing else.
struct DirectResponse {
    core::ResponseSettings response;  ///< of its moments; none when within half a bin
    double end_opl_m = 0.0;           ///< path lengths from here on are free of the direct return
};

/// Measures the direct return of a confocal capture (see find_direct_return()) where it lies, to
/// within 200 ps or 2 bins, at the length of the device segments, and whole on the axis.
///
/// Histograms are moved by their device segments and added up. Of this sum the direct return is
/// what falls from its peak to a thousandth of it, or until it rises again. Its variance and third
/// central moment are those of jitter and tail, a Gaussian and an exponential delay; what bins and
/// moving by whole bins add to the variance is taken off.
///
/// returns   nothing where there is none of the kind
/// throws    nothing
std::optional<DirectResponse> measure_direct_return(const core::Capture& capture);

/// What was found, in words.
std::string describe(const DirectResponse& direct);

}  // namespace nlos
