// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture.h"
#include "renderer/core/progress.h"

#include <string>

namespace apps {

/// Throws core::Error unless a film can be written there: .png, or .mp4 where ffmpeg is installed.
void check_film_path(const std::string& path);

/// Films the light of a capture: bin by bin, or a sequence frame by frame.
///
/// path     .png, which is animated, or .mp4
/// throws   core::Error as film_panels() does, core::Failure when ffmpeg fails
void write_film(const std::string& path,
                const core::Capture& capture,
                const core::Progress& progress);

}  // namespace apps
