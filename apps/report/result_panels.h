// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/reconstruction/reconstruction.h"
#include "renderer/core/capture/capture.h"
#include "renderer/core/settings/json_file.h"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace apps {

/// A name and what it stands for, in words for people.
using Fact = std::pair<std::string, std::string>;

/// A capture, volume or fit, reduced to what a page shows of it.
struct ResultPanel {
    std::string file;
    std::string label;        ///< what to call it: method and setting; empty: its file
    std::string picture_png;  ///< bytes of a PNG file
    std::vector<Fact> facts;
    std::vector<std::string> notes;
    core::Json settings;  ///< how it was made; null when unknown
};

/// What a page shows of a capture, a volume, a fit, a track.
///
/// path     of the file, whose name is shown
/// json     content of the file
/// throws   core::Error as reading them does
ResultPanel capture_panel(const std::string& path, const core::Capture& capture);
ResultPanel volume_panel(const std::string& path, const nlos::Reconstruction& result);
ResultPanel fit_panel(const std::string& path, const core::Json& json);
ResultPanel track_panel(const std::string& path, const core::Json& json);

/// A file's name without its folder, as core::printable() has it: the same wherever a page names
/// it.
std::string shown_file(const std::filesystem::path& path);

/// A number with three significant digits and no exponent where it can be avoided.
std::string short_number(double value);

/// A whole file. Throws core::Error when it cannot be opened.
std::string read_bytes(const std::string& path);

/// The .png of the same name beside a file; nothing when there is none.
std::string picture_beside(const std::string& path);

}  // namespace apps
