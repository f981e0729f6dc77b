// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/preparation/histogram_preparation.h"
#include "nlos/preparation/prepared_capture.h"

#include <string>
#include <vector>

namespace nlos {

/// What a look at a capture tells before a method is run, a line each, for people: what its numbers
/// are, background, where light begins and ends, what was observed, the set-up's response.
///
/// plan   of what becomes of its histograms
std::vector<std::string> survey_capture(const PreparedCapture& prepared,
                                        const PreparationPlan& plan,
                                        const ReconstructSettings& settings);

}  // namespace nlos
