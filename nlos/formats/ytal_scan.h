// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/array_reader.h"
#include "renderer/core/capture/capture.h"

namespace nlos {

/// Reads camera or wall points, how they pair up and where the devices stand from a capture in
/// y-tal's layout; scene_info must be in the capture. What is missing and assumed is noted there.
///
/// Throws core::Error when something needed is missing, not finite, or H does not have one
/// histogram per pair.
void read_ytal_scan(const ArrayReader& file, core::Capture& capture);

}  // namespace nlos
