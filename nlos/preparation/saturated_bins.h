// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/preparation/capture_faults.h"

namespace nlos {

/// Adds saturated bins and points, as find_faults() explains them.
void find_saturated(const core::Capture& capture, CaptureFaults& faults);

}  // namespace nlos
