// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings.h"

#include <array>
#include <optional>
#include <string>

namespace nlos {

/// What a capture file leaves open; empty fields take the format's own defaults.
struct CaptureReadSettings {
    std::optional<int> zero_bins;       ///< leading bins that are dropped (Stanford: 600)
    std::optional<double> bin_width_m;  ///< replaces the file's bin width [m of path]
    std::optional<double> pitch_m;  ///< distance of grid neighbours, where only indices are stored
    std::optional<double> opl_shift_m;  ///< added to the axis start (time zero)
    std::optional<std::array<double, 2>> wall_size_m;  ///< scanned extents along x and y [m]
    std::optional<int> frame;  ///< the only frame to read of a sequence
    std::string layout;        ///< name or JSON file of a layout; empty: recognised by content
};

template <class Visitor>
void for_each_field(CaptureReadSettings& s, Visitor&& visit) {
    visit("zero_bins",
          s.zero_bins,
          core::at_least(0,
                         "leading bins that are set to 0 and count as not observed; null: the "
                         "format's own (Stanford 600)"));
    visit("bin_width_m",
          s.bin_width_m,
          core::above(0, "replaces the file's bin width [m of path length]"));
    visit("pitch_m",
          s.pitch_m,
          core::above(0, "distance of grid neighbours where only indices are stored [m]"));
    visit("opl_shift_m",
          s.opl_shift_m,
          core::Ranged{"added to the start of the axis (time zero) [m]", {}});
    visit("wall_size_m",
          s.wall_size_m,
          core::above(0, "extents of the scanned points along x and y, first to last [m]"));
    visit("frame", s.frame, core::at_least(0, "the only frame to read of a sequence, from 0"));
    visit("layout",
          s.layout,
          "name or JSON file of the layout, as --layout; empty: recognised by content");
}

/// How a capture is written where a format leaves a choice.
struct CaptureWriteSettings {
    /// HDF5: leave out the group /nlos, with which y-tal refuses a file; the unit stands in
    /// scene_info then.
    bool for_ytal = false;
    /// Layout to write, one of those whose files have the suffix; empty: the suffix's first.
    std::string layout;
};

}  // namespace nlos
