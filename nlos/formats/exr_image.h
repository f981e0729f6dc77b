// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/exr_table.h"
#include "renderer/core/capture/capture.h"

#include <string>

namespace nlos {

// The image of a camera as an OpenEXR image, top-left first: one float channel per bin, `bin000`
// and so on, and one per bin of path velocity, `velocity000` and so on, unless these are resolved
// in time. Header attributes:
//
//   nlosFormat                        text: image 1
//   nlosCamera                        text: JSON of core::PinholeCamera
//   nlosUnit                          text: radiance | counts
//   nlosCountsPerRadiance             double, when known
//   nlosOplStartM, nlosBinWidthM      double: start of bin 0 and width of a bin [m of path length]
//   nlosVelocityAxis                  text: JSON of core::VelocityAxis, with velocities
//   nlosSceneInfo                     text: JSON, where the capture came from

/// The value of nlosFormat.
inline constexpr const char* kExrImageFormat = "image 1";

/// An image as the table of such a file; variance, bounce orders, frames and velocities resolved in
/// time have no place in it.
/// capture   with a camera
ExrTable to_exr_image(const core::Capture& capture);

/// The inverse of to_exr_image().
/// throws   core::Error naming the file and what is missing or of another size
core::Capture from_exr_image(const std::string& path, const ExrTable& table);

}  // namespace nlos
