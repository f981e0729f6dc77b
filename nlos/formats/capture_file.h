// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/layouts/capture_settings.h"
#include "renderer/core/capture.h"

#include <optional>
#include <string>
#include <vector>

namespace nlos {

/// Reads a capture in any known format, recognised by its content.
///
/// returns   a valid capture (see core::validate) whose notes say what was converted or assumed
/// throws    core::Error naming the file and what is wrong with it
core::Capture read_capture(const std::string& path, const CaptureReadSettings& settings = {});

/// The name of the format of a file that read_capture() reads, or nothing.
std::optional<std::string> capture_format(const std::string& path);

/// Whether files of this format hold neither bin width nor distances, so that read_capture() must
/// be told both.
bool lacks_scale(const std::string& path);

/// A capture in a few lines for people: wall, points, bins, depth range, unit.
std::vector<std::string> describe_capture(const core::Capture& capture);

/// Writes a capture in the format that the suffix names; whole or not at all: .h5 and .hdf5 the
/// y-tal layout, .exr a streak image, .mat the Stanford 2018 layout.
///
/// y-tal refuses files with any name of its root that it does not know, so the group /nlos (unit,
/// variance, bounce orders, velocities, frames) is written only for captures that have one of these
/// or another unit than radiance.
///
/// returns   what the format does not keep, a sentence each
/// throws    core::Error for a bad target, an unknown suffix or a capture that the format cannot
///           hold, core::Failure when writing fails
std::vector<std::string> write_capture(const std::string& path,
                                       const core::Capture& capture,
                                       const CaptureWriteSettings& settings = {});

/// Throws core::Error unless write_capture() knows the suffix of `path`.
void check_capture_suffix(const std::string& path);

}  // namespace nlos
