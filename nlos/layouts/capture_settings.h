// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"
#include "renderer/core/settings/settings.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace nlos {

/// What a capture file leaves open; empty fields take the format's own defaults.
struct CaptureReadSettings {
    std::optional<int> zero_bins;       ///< leading bins that are dropped (Stanford: 600)
    std::optional<double> bin_width_m;  ///< replaces the file's bin width [m of path]
    std::optional<double> pitch_m;  ///< distance of grid neighbours, where only indices are stored
    std::optional<double> distance_m;   ///< of a sensor before the wall z = 0; lengths start there
    std::optional<double> opl_shift_m;  ///< added to the axis start (time zero)
    std::optional<int> frame;           ///< the only frame to read of a sequence
    std::string layout;  ///< name or JSON file of a layout; empty: recognised by content

    // What replaces the file's word, in captures of any format; see adjust_capture().
    std::optional<std::array<double, 2>> wall_size_m;  ///< extents of the scanned points [m]
    std::optional<core::OplOrigin> opl_origin;         ///< where path lengths start and end
    std::optional<core::TransientUnit> unit;           ///< what the numbers are
    bool swap_xy = false;  ///< histograms were stored with the grid's axes exchanged
    bool flip_x = false;   ///< ... with x running the other way
    bool flip_y = false;   ///< ... with y running the other way
    bool flip_t = false;   ///< ... with time running backwards
    std::optional<std::array<int, 2>> observed_bins;  ///< [begin, end): only these were observed
    std::vector<int> mask_points;  ///< sensing points that are left out, by number
    std::vector<int> mask_bins;    ///< bins that are left out everywhere
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
    visit("distance_m",
          s.distance_m,
          core::above(
              0,
              "distance of a sensor from the wall that it faces, where lengths start and end [m]"));
    visit("opl_shift_m",
          s.opl_shift_m,
          core::Ranged{"added to the start of the axis (time zero) [m]", {}});
    visit("wall_size_m",
          s.wall_size_m,
          core::above(0,
                      "replaces the extents of the scanned points along the grid's x and y axes, "
                      "first to last [m]"));
    visit("opl_origin",
          s.opl_origin,
          "whether path lengths start and end at the wall, or include the segments to laser and "
          "detector (relay_wall|device); null: as the file says");
    visit("unit", s.unit, "what the histograms hold (radiance|counts); null: as the file says");
    visit("swap_xy", s.swap_xy, "exchange the grid's axes: histograms move, points stay");
    visit("flip_x", s.flip_x, "reverse the grid's x axis: histograms move, points stay");
    visit("flip_y", s.flip_y, "reverse the grid's y axis: histograms move, points stay");
    visit("flip_t", s.flip_t, "reverse histograms in time: the axis stays");
    visit("observed_bins",
          s.observed_bins,
          core::at_least(0, "first bin and end of the bins that were observed; null: all"));
    visit("mask_points",
          s.mask_points,
          "numbers of sensing points to leave out, from 0 (x * Y + y on a grid of X x Y)");
    visit("mask_bins", s.mask_bins, "numbers of bins to leave out of every histogram, from 0");
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
