// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/layouts/capture_settings.h"
#include "renderer/core/capture/capture.h"

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace nlos {

/// One capture format that is read other than by a layout. To add one: write a .cpp with a function
/// that returns its row, and list that function in capture_formats.cpp.
struct CaptureFormat {
    using Read = std::function<core::Capture(const CaptureReadSettings& settings)>;

    const char* name;  ///< for people

    /// What reads a file of this format, be it damaged further on; nothing for any other file.
    Read (*open)(const std::string& path);
};

/// All formats, in the order in which a file is tried.
const std::vector<CaptureFormat>& capture_formats();

/// Writes a capture and says, a sentence each, what the layout does not keep. Throws core::Error
/// for a capture that it cannot hold.
using WriteCapture = std::vector<std::string>(const std::string& path,
                                              const core::Capture& capture,
                                              const CaptureWriteSettings& settings);

/// One layout that is written. To add one: write a .cpp with its `write`, and list it in
/// capture_formats.cpp.
struct CaptureWriter {
    const char* layout;                   ///< what CaptureWriteSettings::layout calls it
    std::array<const char*, 2> suffixes;  ///< of its files, with their dot
    WriteCapture* write;
};

/// All layouts that are written. The first one of a suffix is taken when none is asked for.
const std::vector<CaptureWriter>& capture_writers();

/// The sentence that names what a capture holds beside points, axis, unit and histograms, and that
/// it is left out; nothing when there is no more.
std::optional<std::string> extras_left_out(const core::Capture& capture);

/// The coordinates of points, one point after the other, in the precision of the files.
std::vector<float> to_floats(const std::vector<core::Vec3>& points);

/// Points from their coordinates, one point after the other.
template <class T>
std::vector<core::Vec3> to_points(const std::vector<T>& values) {
    std::vector<core::Vec3> points;
    points.reserve(values.size() / 3);
    for (std::size_t i = 0; i + 2 < values.size(); i += 3) {
        points.emplace_back(values[i], values[i + 1], values[i + 2]);
    }
    return points;
}

}  // namespace nlos
