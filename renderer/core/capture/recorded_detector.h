// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"
#include "renderer/core/capture/instrument_response.h"

#include <optional>
#include <string>
#include <vector>

namespace core {

/// A response in words: "a response of 100 ps (FWHM)".
///
/// response   stated, see is_stated()
std::string describe(const ResponseSettings& response);

/// A spot in words: "a spot of 0.08 m on the wall (FWHM)".
std::string describe_spot(double fwhm_m);

/// The response that a capture's provenance says its detector had, as `simulate-noise` writes it;
/// nothing when it says nothing of the kind.
std::optional<ResponseSettings> recorded_response(const Capture& capture);

/// Full width at half maximum of the spot on the wall that a capture's provenance says its set-up
/// lit and saw [m], as layouts of files that hold it state it; nothing when it says none.
std::optional<double> recorded_spot_m(const Capture& capture);

/// The response asked for; that of the capture when the text `capture` was.
///
/// throws   Error naming `where` when the capture's provenance states none
ResponseSettings resolve_response(const ResponseSettings& asked,
                                  const Capture& capture,
                                  const std::string& where);

/// What a capture's provenance states of its detector that is left aside although it matters: a
/// response of more than half a bin that is not among what is used, and pile-up of more than a few
/// photons in a hundred. A sentence each, for people.
///
/// used   response that is taken into account
std::vector<std::string> detector_warnings(const Capture& capture, const ResponseSettings& used);

}  // namespace core
