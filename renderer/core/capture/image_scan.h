// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/pinhole_camera.h"
#include "renderer/core/capture/wall_scan.h"

#include <string>
#include <string_view>
#include <vector>

namespace core {

/// A kind of scan: the pixels of a camera, numbered as PinholeCamera says. Path lengths run from
/// its light to the pinhole.
struct ImageScan {
    PinholeCamera camera;

    static constexpr ScanPattern pattern = ScanPattern::Single;
    static constexpr OplOrigin opl_origin = OplOrigin::Device;

    /// Bins that nobody observed hold 0, which is taken for darkness.
    static constexpr bool has_observed_bins = false;

    std::string_view name() const { return "camera"; }
    std::size_t num_pairs() const { return camera.num_pixels(); }
    std::vector<std::size_t> pair_extents() const { return {camera.width(), camera.height()}; }
    Devices devices() const { return {camera.light_position(), camera.position_m}; }
    std::vector<Vec3> path_ends() const { return {camera.position_m, camera.light_position()}; }
};

inline void validate(const ImageScan& scan, const std::string& where) {
    validate(scan.camera, where + ": camera");
}

}  // namespace core
