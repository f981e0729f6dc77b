// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/formats/capture_file.h"

#include <string>
#include <vector>

namespace apps {

/// Draws a file: a scene.json as its wall sees it, a capture as streak image, integrated image and
/// mean transient, a volume by its projections and depth map.
///
/// paths      one file, or the frames of a capture
/// settings   of a capture
/// throws     core::Error for other kinds of files and bad targets
void write_picture(const std::vector<std::string>& paths,
                   const std::string& png_path,
                   const nlos::CaptureReadSettings& settings = {});

}  // namespace apps
