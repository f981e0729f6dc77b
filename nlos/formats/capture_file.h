// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture.h"

#include <optional>
#include <string>
#include <vector>

namespace nlos {

/// What a capture file leaves open; empty fields take the format's own defaults.
struct CaptureReadSettings {
    std::optional<int> zero_bins;       ///< leading bins set to 0 (Stanford: 600)
    std::optional<double> bin_width_m;  ///< replaces the file's bin width [m of path]
    std::optional<double> pitch_m;  ///< distance of grid neighbours, where only indices are stored
    std::optional<double> opl_shift_m;  ///< added to the axis start (time zero)
};

template <class Visitor>
void for_each_field(CaptureReadSettings& s, Visitor&& visit) {
    visit("zero_bins", s.zero_bins, "leading bins set to 0; null: the format's own (Stanford 600)");
    visit("bin_width_m", s.bin_width_m, "replaces the file's bin width [m of path length]");
    visit("pitch_m", s.pitch_m, "distance of grid neighbours where only indices are stored [m]");
    visit("opl_shift_m", s.opl_shift_m, "added to the start of the axis (time zero) [m]");
}

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

/// How a capture is written where a format leaves a choice.
struct CaptureWriteSettings {
    /// HDF5: leave out the group /nlos, with which y-tal refuses a file; the unit stands in
    /// scene_info then.
    bool for_ytal = false;
};

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
