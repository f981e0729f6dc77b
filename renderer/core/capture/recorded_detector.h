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
/// response   given, see is_given()
std::string describe(const ResponseSettings& response);

/// A spot in words: "a spot of 0.08 m on the wall (FWHM)".
std::string describe_spot(double fwhm_m);

/// The response that a capture's provenance says its detector had, as `simulate-noise` writes it;
/// nothing when it says nothing of the kind.
std::optional<ResponseSettings> recorded_response(const Capture& capture);

/// Full width at half maximum of the spot on the wall that a capture's provenance says its set-up
/// lit and saw [m], as layouts of files that hold it state it; nothing when it says none.
std::optional<double> recorded_spot_m(const Capture& capture);

/// The response asked for; where none is, that of the capture, if it gives one of more than half a
/// bin.
///
/// throws   Error naming `where` when `capture` is asked for, and its provenance gives none
ResponseSettings resolve_response(const ResponseSettings& asked,
                                  const Capture& capture,
                                  const std::string& where);

/// The response asked for, of a detector that is to count this light; where none is, the jitter of
/// the detector that the light was rendered for, if its scene states one.
ResponseSettings resolve_scene_response(const ResponseSettings& asked, const Capture& capture);

/// What a capture's provenance gives of its detector that no method models: pile-up of more than a
/// few photons in a hundred. A sentence, for people.
std::optional<std::string> detector_warning(const Capture& capture);

}  // namespace core
