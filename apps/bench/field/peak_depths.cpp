// SPDX-License-Identifier: MIT
#include "apps/bench/field/peak_depths.h"

#include "nlos/containers/array_reader.h"
#include "nlos/reconstruction/column_peak.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <span>

namespace apps {

core::DepthMap peak_depths(const nlos::Volume& volume) {
    const nlos::VolumeAxes& axes = volume.axes;
    core::DepthMap depth(axes.x_m, axes.y_m);
    depth.world_from_wall = axes.world_from_wall;
    const std::size_t num_depths = axes.z_m.size();
    const float brightest = *std::max_element(volume.values.begin(), volume.values.end());
    const double pitch_m =
        num_depths < 2 ? 0.0
                       : (axes.z_m.back() - axes.z_m.front()) / static_cast<double>(num_depths - 1);
    for (std::size_t c = 0; c < depth.depth_m.size(); ++c) {
        const std::span<const float> column(volume.values.data() + c * num_depths, num_depths);
        const auto highest = std::max_element(column.begin(), column.end());
        if (!(double{*highest} > kPeakFraction * double{brightest})) continue;
        const auto voxel = static_cast<std::size_t>(highest - column.begin());
        depth.depth_m[c] = axes.z_m.front() + pitch_m * nlos::find_peak(column, voxel).position;
    }
    return depth;
}

nlos::Volume read_peer_volume(const std::string& path, const nlos::VolumeAxes& asked) {
    const nlos::ArrayReader file(path);
    nlos::Volume volume{asked, {}, {}};
    std::vector<double>& z_m = volume.axes.z_m;
    if (file.has("z_m")) {
        z_m = file.read_doubles("z_m", file.shape("z_m"));
        const double pitch_m = z_m.size() < 2 ? 0.0 : z_m[1] - z_m[0];
        for (std::size_t i = 1; i < z_m.size(); ++i) {
            if (std::abs(z_m[i] - z_m[i - 1] - pitch_m) < 1e-3 * pitch_m) continue;
            throw core::Error(file.where("z_m"),
                              fmt::format("found {} m after {} m", z_m[i], z_m[i - 1]),
                              "must rise evenly");
        }
    }
    volume.values = file.read_floats("volume", {asked.x_m.size(), asked.y_m.size(), z_m.size()});
    // What is not finite is not seen by the peer either.
    for (float& value : volume.values) {
        if (!std::isfinite(value)) value = 0.0F;
    }
    return volume;
}

}  // namespace apps
