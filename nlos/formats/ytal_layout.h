// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/formats/capture_file.h"
#include "renderer/core/settings/json_fwd.h"

#include <string>
#include <utility>
#include <vector>

namespace nlos {

// The layout of y-tal's capture files (source [Royo2023], file format of package y-tal 0.20).
// Members of enumerations are listed by name, the order in which h5py writes them.

using EnumMembers = std::vector<std::pair<const char*, int>>;

enum class HFormat { Unknown = 0, TSxSy = 1, TLxLySxSy = 2, TSi = 3, TLiSi = 4 };
inline constexpr int kFirstFrequencyFormat = 10;
enum class GridFormat { Unknown = 0, N3 = 1, XY3 = 2 };
inline constexpr int kVolumeFormatXYZ3 = 2;

inline EnumMembers h_format_members() {
    return {{"F_Li_Si", 13},
            {"F_Lx_Ly_Sx_Sy", 11},
            {"F_Si", 12},
            {"F_Sx_Sy", 10},
            {"T_Li_Si", 4},
            {"T_Lx_Ly_Sx_Sy", 2},
            {"T_Si", 3},
            {"T_Sx_Sy", 1},
            {"UNKNOWN", 0}};
}

inline EnumMembers grid_format_members() {
    return {{"N_3", 1}, {"UNKNOWN", 0}, {"X_Y_3", 2}};
}

inline EnumMembers volume_format_members() {
    return {{"N_3", 1}, {"UNKNOWN", 0}, {"X_Y_3", 3}, {"X_Y_Z_3", 2}};
}

/// The key of scene_info that holds the camera of an image, whose grids are null: y-tal's layout
/// has no place for it.
inline constexpr const char* kCameraKey = "camera";

/// Attributes of /nlos/frames: how far gate and objects move on per frame.
inline constexpr const char* kGateStep = "gate_step_m";
inline constexpr const char* kFrameTime = "frame_s";

/// Attributes of H: the first and last bounce order that its render left out, the relative L2 error
/// of that, and the share of the light. y-tal opens files with them, as it does with scene_info.
inline constexpr const char* kLeftOutOrders = "orders_left_out";
inline constexpr const char* kLeftOutError = "orders_left_out_error";
inline constexpr const char* kLeftOutShare = "orders_left_out_share";

/// Attributes of /nlos/velocity: its axis, and the carrier that Doppler shifts are given for.
inline constexpr const char* kVelocityStart = "start_m_per_s";
inline constexpr const char* kVelocityBinWidth = "bin_width_m_per_s";
inline constexpr const char* kVelocityCarrier = "carrier_hz";

/// The key of scene_info that holds the unit where the group /nlos is left out.
inline constexpr const char* kUnitKey = "nlos_unit";

/// A dictionary as text that both JSON and YAML 1.1 readers understand.
///
/// A dictionary whose only key is "yaml" stands for a YAML text that is no JSON; it gives that
/// text.
std::string scene_info_text(const core::Json& scene_info);

/// The inverse of scene_info_text().
core::Json parse_scene_info(const std::string& text);

}  // namespace nlos
