// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/layouts/capture_settings.h"
#include "nlos/layouts/layout.h"
#include "renderer/core/capture/capture.h"

#include <optional>
#include <string>
#include <vector>

namespace nlos {

/// Files that one capture is read from: one, or its frames in order.
struct LayoutSource {
    Layout layout;
    std::vector<std::string> files;
};

/// The shipped layout that a file is of, or a folder: of the frames that it holds, or of the file
/// in it that the layout needs. Nothing when there is none.
std::optional<LayoutSource> find_layout_source(const std::string& path);

/// The files that make up a capture at `path` when its layout is known.
/// Throws core::Error when there is none that is of this layout, naming what the first one lacks.
LayoutSource layout_source(const std::string& path, const Layout& layout);

/// Files that are the frames of one sequence, in this order.
/// Throws core::Error unless all are of the layout and its files are frames.
LayoutSource sequence_source(const std::vector<std::string>& files, const Layout& layout);

/// Reads a capture.
///
/// returns   a capture whose notes say what the layout given and assumed
/// throws    core::Error naming file and array; a setting that the layout asks for and that is not
///           given is named with typical values
core::Capture read_layout_capture(const LayoutSource& source, const CaptureReadSettings& settings);

/// The settings that a layout asks for and that are not given.
std::vector<std::string> open_questions(const Layout& layout, const CaptureReadSettings& settings);

}  // namespace nlos
