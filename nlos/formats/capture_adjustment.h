// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/layouts/capture_settings.h"
#include "renderer/core/capture/capture.h"

#include <string>

namespace nlos {

/// A capture as the settings correct what its file says, whatever the format; each correction
/// leaves a note.
///
/// wall_size_m             scanned points (the longer list; sensing points when both are equal) are
///                         stretched around their middle, along the axes of their grid, or x and y
///                         of the world without one; the other list goes along unless it is a
///                         single point; an axis without extent stays
/// opl_origin, unit        replace the file's
/// swap_xy                 histograms move to the points that the grid has with its axes exchanged;
///                         a grid that is not square is read in the other order
/// flip_x, flip_y          histograms move to the points on the other side, after swap_xy
/// flip_t                  the last bin becomes the first; the axis stays
/// opl_shift_m             moves the axis
/// observed_bins           bins outside are set to 0 and count as not observed, last of all
///
/// Of an exhaustive scan, histograms move among illumination and sensing points alike.
///
/// where    prefix of messages, usually the file's name
/// throws   core::Error where a setting needs wall points, or a grid, that the capture lacks
core::Capture adjust_capture(core::Capture capture,
                             const CaptureReadSettings& settings,
                             const std::string& where);

}  // namespace nlos
