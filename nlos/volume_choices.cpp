// SPDX-License-Identifier: MIT
#include "nlos/volume_choices.h"

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

constexpr std::size_t kDefaultColumns = 64;

/// Distance of voxels along z unless set: a bin's range, or what the virtual wave resolves.
double default_depth_step_m(const core::TimeAxis& axis, const ReconstructSettings& settings) {
    const double bin = 0.5 * axis.bin_width_m;
    return traits_of(settings).propagates_wave ? std::max(bin, *settings.phasor.wavelength_m / 8.0)
                                               : bin;
}

}  // namespace

VolumeAxes choose_axes(const PreparedCapture& prepared,
                       const core::TimeAxis& axis,
                       ReconstructSettings& settings) {
    const WallFrame& wall = prepared.wall;
    VolumeSettings& volume = settings.volume;
    const double depth = (*volume.z_range_m)[1] - (*volume.z_range_m)[0];
    std::array<double, 2> low = wall.min_m;
    std::array<double, 2> high = wall.max_m;
    for (int i = 0; i < 2 && wall.grid; ++i) {  // other points may lie outside the grid
        low[i] = wall.grid->first_m[i] - 0.5 * wall.grid->pitch_m[i];
        high[i] = low[i] + static_cast<double>(wall.grid->size[i]) * wall.grid->pitch_m[i];
    }
    const double size = std::max(high[0] - low[0], high[1] - low[1]);
    for (int i = 0; i < 2; ++i) {  // points on a line, or one point: a square, or as wide as deep
        if (high[i] - low[i] > 1e-3 * size && size > 0.0) continue;
        const double center = 0.5 * (low[i] + high[i]);
        low[i] = center - 0.5 * (size > 0.0 ? size : depth);
        high[i] = center + 0.5 * (size > 0.0 ? size : depth);
    }
    if (!volume.voxels) {
        const std::array<std::size_t, 2> columns =
            wall.grid ? wall.grid->size : std::array{kDefaultColumns, kDefaultColumns};
        const double step = default_depth_step_m(axis, settings);
        volume.voxels = {
            static_cast<int>(columns[0]),
            static_cast<int>(columns[1]),
            static_cast<int>(std::clamp(std::round(depth / step), 1.0, double{kMaxVoxelsPerAxis}))};
    }
    const auto [nx, ny, nz] = *volume.voxels;
    const auto [near_m, far_m] = *volume.z_range_m;
    return {cell_centers(low[0], high[0], static_cast<std::size_t>(nx)),
            cell_centers(low[1], high[1], static_cast<std::size_t>(ny)),
            cell_centers(near_m, far_m, static_cast<std::size_t>(nz)),
            wall.world_from_wall};
}

}  // namespace nlos
