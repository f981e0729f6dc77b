// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace apps {

enum class FileKind {
    Scene,
    Fit,
    Metrics,
    Model,
    Setup,
    Calibration,
    Sweep,
    Track,
    Volume,
    Geometry,
    PointCloud,
    Capture
};

/// What a file is, by suffix and content; JSON without lists that is nothing else counts as a scene
/// and any other unknown file as a capture, whose readers then say what they expect. Throws
/// core::Error when there is no such file.
FileKind kind_of_file(const std::string& path);

}  // namespace apps
