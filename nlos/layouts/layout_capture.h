// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/layouts/capture_settings.h"
#include "nlos/layouts/layout_source.h"
#include "renderer/core/capture/capture.h"

#include <string>
#include <vector>

namespace nlos {

/// Reads a capture.
///
/// returns   a capture whose notes say what the layout stated and assumed
/// throws    core::Error naming file and array; a setting that the layout asks for and that is not
///           given is named with typical values
core::Capture read_layout_capture(const LayoutSource& source, const CaptureReadSettings& settings);

/// The settings that a layout asks for and that are not given.
std::vector<std::string> open_questions(const Layout& layout, const CaptureReadSettings& settings);

}  // namespace nlos
