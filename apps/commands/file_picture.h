// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/formats/capture_file.h"

#include <string>
#include <vector>

namespace apps {

/// Draws a file: a scene.json as its wall sees it, a capture as streak image, integrated image and
/// mean transient, a volume by its projections and depth map.
///
/// paths          one file, or the frames of a capture
/// picture_path   .png, .svg or .pdf
/// settings       of a capture
/// throws         core::Error for other kinds of files
void write_picture(const std::vector<std::string>& paths,
                   const std::string& picture_path,
                   const nlos::CaptureReadSettings& settings = {});

}  // namespace apps
