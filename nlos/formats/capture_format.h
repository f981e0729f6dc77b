// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/layouts/capture_settings.h"
#include "renderer/core/capture.h"

#include <array>
#include <string>
#include <vector>

namespace nlos {

/// One known capture format. To add one: write a .cpp with a function that returns its row, and
/// list that function in capture_formats.cpp.
struct CaptureFormat {
    const char* name;     ///< for people
    const char* content;  ///< what its files hold, for the message about an unknown file

    /// True when the file is of this format, be it damaged further on. Null for formats that only
    /// write, whose files a layout reads.
    bool (*recognise)(const std::string& path);
    core::Capture (*read)(const std::string& path, const CaptureReadSettings& settings);

    /// Suffixes of the files that `write` makes, with their dot; none: read only.
    std::array<const char*, 2> suffixes{};
    /// Writes a capture and says, a sentence each, what the format does not keep.
    std::vector<std::string> (*write)(const std::string& path,
                                      const core::Capture& capture,
                                      const CaptureWriteSettings& settings) = nullptr;
};

/// All formats, in the order in which a file is tried.
const std::vector<CaptureFormat>& capture_formats();

/// The coordinates of points, one point after the other, in the precision of the files.
std::vector<float> to_floats(const std::vector<core::Vec3>& points);

}  // namespace nlos
