// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/layouts/capture_settings.h"
#include "renderer/core/capture/capture.h"

#include <optional>
#include <string>
#include <vector>

namespace nlos {

/// Reads a capture: in one of the formats that the program also writes, or any file of named arrays
/// of which a layout says what they mean (see nlos/layouts/layout.h), recognised by content. A
/// folder is a capture when its files are the frames of one, or a layout keeps its arrays in files.
///
/// returns   a valid capture (see core::validate) whose notes say what was converted or assumed
/// throws    core::Error naming the file and what is wrong with it
core::Capture read_capture(const std::string& path, const CaptureReadSettings& settings = {});

/// The same from several files, at least one: the frames of a sequence in this order, where their
/// layout says that files are frames.
core::Capture read_capture(const std::vector<std::string>& paths,
                           const CaptureReadSettings& settings = {});

/// The name of the format or layout that read_capture() would read a file by, or nothing.
std::optional<std::string> capture_format(const std::string& path,
                                          const CaptureReadSettings& settings = {});

/// Settings that read_capture() must be given because the file does not hold them, each as
/// `capture.key=... (typical values)`.
std::vector<std::string> missing_settings(const std::string& path,
                                          const CaptureReadSettings& settings);

/// A capture in a few lines for people: wall, points, bins, depth range, unit.
std::vector<std::string> describe_capture(const core::Capture& capture);

/// Writes a capture in the layout that settings name or else the suffix; whole or not at all: .h5
/// and .hdf5 as y-tal, .npz for NumPy, .exr a streak image, .mat as stanford-2018 and, where asked
/// for, as stanford-fk-2019 (MATLAB v7.3) or conv-nlos.
///
/// y-tal refuses files with any name of its root that it does not know, so the group /nlos (unit,
/// variance, bounce orders, velocities, frames) is written only for captures that have one of these
/// or another unit than radiance.
///
/// returns   what the layout does not keep, a sentence each
/// throws    core::Error for a bad target, an unknown suffix or layout, or a capture that the
///           layout cannot hold; core::Failure when writing fails
std::vector<std::string> write_capture(const std::string& path,
                                       const core::Capture& capture,
                                       const CaptureWriteSettings& settings = {});

/// Throws core::Error unless write_capture() knows the suffix of `path` and the layout.
void check_capture_suffix(const std::string& path, const CaptureWriteSettings& settings = {});

/// A capture as the settings correct what its file says, whatever the format; each correction
/// leaves a note.
///
/// wall_size_m             scanned points (the longer list; sensing points when both are equal) are
///                         stretched around their middle, along the axes of their grid, or x and y
///                         of the world without one; the other list goes along unless it is a
///                         single point; an axis without extent stays
/// opl_origin, unit        replace the file's
/// swap_xy                 histograms move to the points that the grid has with its axes exchanged;
///                         a grid that is not square is read in the other order
/// flip_x, flip_y          histograms move to the points on the other side, after swap_xy
/// flip_t                  the last bin becomes the first; the axis stays
/// opl_shift_m             moves the axis
/// observed_bins           bins outside are set to 0 and count as not observed, last of all
///
/// Of an exhaustive scan, histograms move among illumination and sensing points alike.
///
/// where    prefix of messages, usually the file's name
/// throws   core::Error where a setting needs wall points, or a grid, that the capture lacks
core::Capture adjust_capture(core::Capture capture,
                             const CaptureReadSettings& settings,
                             const std::string& where);

}  // namespace nlos
