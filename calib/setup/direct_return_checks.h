// SPDX-License-Identifier: MIT
#pragma once

#include "calib/setup/direct_returns.h"

#include <string>
#include <vector>

namespace calib {

/// Throws core::Error for a histogram that holds no light or negative counts, and core::Failure
/// where detector or file clipped the peaks.
void require_peaks(const core::Capture& capture);

/// What casts doubt on the fitted peaks: numbers that are no counts, and a shape that is not that
/// of the response. A sentence each.
///
/// scatter   of the deviance around its expectation, one standard deviation
std::vector<std::string> peak_warnings(const core::Capture& capture,
                                       const DirectReturns& result,
                                       double scatter);

}  // namespace calib
