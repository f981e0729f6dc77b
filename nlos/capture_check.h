// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture.h"

#include <string>
#include <vector>

namespace nlos {

/// What looks wrong about a capture's time axis, a sentence each, for people:
///
/// - light that arrives before the shortest possible path, |l - s| plus device legs: time zero is
///   late;
/// - first light that moves along the wall faster than any path length can change (1 m per metre of
///   sensing point, 2 if confocal): bins are narrower than stated.
///
/// returns   empty when nothing does; never for captures too small or dark to tell, nor for images
/// throws    nothing
std::vector<std::string> timing_warnings(const core::Capture& capture);

}  // namespace nlos
