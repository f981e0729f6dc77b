// SPDX-License-Identifier: MIT
#include "nlos/methods/backprojection.h"
#include "nlos/methods/slabs.h"

#include <algorithm>
#include <cmath>

// Confocal grids. The path length 2 sqrt(dx^2 + dy^2 + z^2) depends only on depth and offset, so
// for one depth, one wall row (fixed x) and one |dx|, the sum over that row's points is a sum of
// shifted rows of histogram slices: contiguous loads, fixed weights, no gathers, sums kept in
// registers. The result serves the voxel rows on both sides, at +dx and -dx.

namespace nlos {
namespace {

constexpr std::size_t kLanes = 16;

template <class Real>
using Lanes = Eigen::Array<Real, static_cast<int>(kLanes), 1>;

/// Every `step`-th element of [0, count) from `first` on: how many there are.
std::size_t class_size(std::size_t count, std::size_t first, std::size_t step) {
    return first < count ? (count - first + step - 1) / step : 0;
}

/// Histograms of one class of the wall points of some rows, stored [x][bin][y], y padded by zeros
/// on both sides so that any shift can be loaded, and one bin of zeros before and after the axis.
template <class Real>
struct Slices {
    Slab walls;  ///< rows of the wall grid, each at one x
    std::vector<Real> values;
    std::size_t num_y = 0;
    std::size_t row_stride = 0;
    std::size_t num_bins = 0;
    double first_y_m = 0.0;

    const Real* wall_row(std::size_t ix) const {
        return values.data() + (ix - walls.begin) * (num_bins + 2) * row_stride;
    }
};

/// The axis of all points once device segments are taken off: starts at the longest segment's bin
/// 0.
template <class Real>
core::TimeAxis wall_axis(const ConfocalGrid<Real>& data) {
    core::TimeAxis axis = data.time_axis;
    if (data.device_segments_m.empty()) return axis;
    const auto [low, high] =
        std::minmax_element(data.device_segments_m.begin(), data.device_segments_m.end());
    axis.opl_start_m -= *high;
    axis.num_bins += static_cast<int>(std::ceil((*high - *low) / axis.bin_width_m - 1e-9));
    return axis;
}

template <class Real>
Slices<Real> make_slices(const ConfocalGrid<Real>& data,
                         const core::TimeAxis& axis,
                         const Slab& walls,
                         std::size_t first_y,
                         std::size_t step) {
    Slices<Real> slices;
    slices.walls = walls;
    slices.num_y = class_size(data.grid.size[1], first_y, step);
    slices.row_stride = slices.num_y + 2 * (kLanes - 1);
    slices.num_bins = static_cast<std::size_t>(axis.num_bins);
    slices.first_y_m = data.grid.y_m(first_y);
    slices.values.assign(walls.size() * (slices.num_bins + 2) * slices.row_stride, Real{0});
    const auto num_bins = static_cast<std::size_t>(data.time_axis.num_bins);
    core::parallel_for(walls.size(), [&](std::size_t row) {
        Real* rows = slices.values.data() + row * (slices.num_bins + 2) * slices.row_stride;
        for (std::size_t n = 0; n < slices.num_y; ++n) {
            const std::size_t point = data.grid.point(walls.begin + row, first_y + n * step);
            const double segment =
                data.device_segments_m.empty() ? 0.0 : data.device_segments_m[point];
            const double shift =
                (data.time_axis.opl_start_m - segment - axis.opl_start_m) / axis.bin_width_m;
            const double whole = std::floor(shift + 1e-9);
            const double late = std::max(0.0, shift - whole);
            Real* out =
                rows + (static_cast<std::size_t>(whole) + 1) * slices.row_stride + n + (kLanes - 1);
            for (std::size_t bin = 0; bin < num_bins; ++bin) {
                const Real value = data.histograms[point * num_bins + bin];
                out[bin * slices.row_stride] += static_cast<Real>(1.0 - late) * value;
                out[(bin + 1) * slices.row_stride] += static_cast<Real>(late) * value;
            }
        }
    });
    return slices;
}

/// Where a shifted row is read and how its two bins weigh.
template <class Real>
struct Tap {
    std::size_t offset = 0;
    Real early = 0;
    Real late = 0;
};

/// All shifts at one depth and |dx|; those before `first` and from `end` on are off the axis.
template <class Real>
struct Taps {
    std::vector<Tap<Real>> all;
    std::size_t first = 0;
    std::size_t end = 0;
};

/// Offsets of voxels and wall points along y at shift 0, and their number.
struct ShiftRange {
    double offset_m = 0.0;
    double pitch_m = 0.0;
    std::size_t num_voxels_padded = 0;
    std::size_t num_wall = 0;
    Compensation compensation = Compensation::None;
};

/// Factor of a term whose light went `range_m` out and as far back.
double lost_light(Compensation compensation, double range_m) {
    if (compensation == Compensation::None) return 1.0;
    return std::pow(range_m, compensation == Compensation::Diffuse ? 4.0 : 2.0);
}

template <class Real>
void fill_taps(const ShiftRange& range,
               const core::TimeAxis& axis,
               double squared_rest,
               std::size_t row_stride,
               Taps<Real>& taps) {
    taps.all.assign(range.num_voxels_padded - 1 + range.num_wall, {});
    taps.first = taps.all.size();
    taps.end = 0;
    for (std::size_t i = 0; i < taps.all.size(); ++i) {
        const double shift =
            static_cast<double>(i) - static_cast<double>(range.num_voxels_padded - 1);
        const double dy = range.offset_m + shift * range.pitch_m;
        const double opl = 2.0 * std::sqrt(squared_rest + dy * dy);
        const double position = (opl - axis.opl_start_m) / axis.bin_width_m - 0.5;
        const double bin = std::floor(position);
        if (!(bin >= -1.0) || !(bin < axis.num_bins)) continue;
        const double late = position - bin;
        const double factor = lost_light(range.compensation, 0.5 * opl);
        taps.all[i] = {static_cast<std::size_t>(bin + 1.0) * row_stride,
                       static_cast<Real>(factor * (1.0 - late)),
                       static_cast<Real>(factor * late)};
        taps.first = std::min(taps.first, i);
        taps.end = i + 1;
    }
}

/// Sum of shifted rows for kLanes neighbouring voxels; four at once hide the latency of adding.
///
/// row   where the first tap's shift starts to read; each further tap reads one element later
template <class Real>
Lanes<Real> sum_shifted_rows(const Real* row,
                             std::size_t row_stride,
                             std::span<const Tap<Real>> taps) {
    const auto term = [&](std::size_t i) {
        const Real* early = row + taps[i].offset + i;
        const Real* late = early + row_stride;
        return taps[i].early * Eigen::Map<const Lanes<Real>>(early) +
               taps[i].late * Eigen::Map<const Lanes<Real>>(late);
    };
    Lanes<Real> sum0 = Lanes<Real>::Zero();
    Lanes<Real> sum1 = sum0;
    Lanes<Real> sum2 = sum0;
    Lanes<Real> sum3 = sum0;
    std::size_t i = 0;
    for (; i + 4 <= taps.size(); i += 4) {
        sum0 += term(i);
        sum1 += term(i + 1);
        sum2 += term(i + 2);
        sum3 += term(i + 3);
    }
    for (; i < taps.size(); ++i) sum0 += term(i);
    return (sum0 + sum1) + (sum2 + sum3);
}

/// One class of voxels along y at one depth: sums kept as [x][y], y padded to whole lanes.
template <class Real>
struct VoxelSlab {
    VoxelSlab(std::size_t num_x, std::size_t num_y)
        : row_stride((num_y + kLanes - 1) / kLanes * kLanes), values(num_x * row_stride, Real{0}) {}

    std::size_t row_stride;
    std::vector<Real> values;
};

/// Adds what the wall points of `slices` contribute to the voxels of `slab`.
template <class Real>
void add_slices(const Slices<Real>& slices,
                const RowPairs& rows,
                const std::vector<Taps<Real>>& taps_of_distance,
                VoxelSlab<Real>& slab) {
    for (std::size_t wall = slices.walls.begin; wall < slices.walls.end; ++wall) {
        const Real* wall_row = slices.wall_row(wall);
        for (const Offset& offset : rows.of_wall_row[wall]) {
            const Taps<Real>& taps = taps_of_distance[offset.distance];
            for (std::size_t voxel = 0; voxel < slab.row_stride; voxel += kLanes) {
                // The first shift that reaches the last lane of these voxels, and the shifts until
                // the first lane leaves the wall row.
                const std::size_t lowest = slab.row_stride - voxel - kLanes;
                const std::size_t first = std::max(lowest, taps.first);
                const std::size_t end = std::min(lowest + slices.num_y + kLanes - 1, taps.end);
                if (first >= end) continue;
                const Lanes<Real> sum =
                    sum_shifted_rows<Real>(wall_row + (first - lowest),
                                           slices.row_stride,
                                           std::span(taps.all).subspan(first, end - first));
                for (const std::size_t voxel_row : offset.voxel_rows) {
                    Eigen::Map<Lanes<Real>>(slab.values.data() + voxel_row * slab.row_stride +
                                            voxel) += sum;
                }
            }
        }
    }
}

/// Adds what some of the wall's rows contribute to `volume`.
template <class Real>
void backproject_rows(const ConfocalGrid<Real>& data,
                      const VolumeAxes& axes,
                      const RowPairs& rows,
                      const Slab& walls,
                      std::span<Real> volume,
                      const ProgressSpan& span) {
    const CommonLattice lattice = common_lattice(data.grid, axes.y_m).value();
    const core::TimeAxis axis = wall_axis(data);
    std::vector<Slices<Real>> classes;
    for (std::size_t q = 0; q < std::min(lattice.wall_step, data.grid.size[1]); ++q) {
        classes.push_back(make_slices(data, axis, walls, q, lattice.wall_step));
    }
    const std::size_t num_y = axes.y_m.size();
    const std::size_t num_z = axes.z_m.size();

    const auto fill_depth = [&](std::size_t iz) {
        std::vector<Taps<Real>> taps(rows.distances_m.size());
        for (std::size_t first_y = 0; first_y < std::min(lattice.voxel_step, num_y); ++first_y) {
            VoxelSlab<Real> slab(axes.x_m.size(), class_size(num_y, first_y, lattice.voxel_step));
            for (const Slices<Real>& slices : classes) {
                const ShiftRange range{
                    slices.first_y_m - axes.y_m[first_y],
                    data.grid.pitch_m[1] * static_cast<double>(lattice.wall_step),
                    slab.row_stride,
                    slices.num_y,
                    data.compensation};
                for (std::size_t d = 0; d < taps.size(); ++d) {
                    const double dx = rows.distances_m[d];
                    const double z = axes.z_m[iz];
                    fill_taps(range, axis, dx * dx + z * z, slices.row_stride, taps[d]);
                }
                add_slices(slices, rows, taps, slab);
            }
            for (std::size_t ix = 0; ix < axes.x_m.size(); ++ix) {
                for (std::size_t iy = first_y, n = 0; iy < num_y; iy += lattice.voxel_step, ++n) {
                    volume[(ix * num_y + iy) * num_z + iz] += slab.values[ix * slab.row_stride + n];
                }
            }
        }
    };
    parallel_blocks_with_progress(num_z, 1, span, [&](std::size_t begin, std::size_t end) {
        for (std::size_t iz = begin; iz < end; ++iz) fill_depth(iz);
    });
}

}  // namespace

template <class Real>
void backproject_confocal_grid(const ConfocalGrid<Real>& data,
                               const VolumeAxes& axes,
                               std::span<Real> volume,
                               const core::Progress& progress,
                               std::size_t num_slabs) {
    const RowPairs rows = pair_rows(data.grid, axes.x_m);
    const std::size_t num_rows = data.grid.size[0];
    for (const Slab& walls : split_into_slabs(num_rows, num_slabs)) {
        const core::Progress part = walls.part_of(progress, num_rows);
        backproject_rows(data, axes, rows, walls, volume, {part, 0.0, 1.0, "backprojection"});
    }
}

template void backproject_confocal_grid<float>(const ConfocalGrid<float>&,
                                               const VolumeAxes&,
                                               std::span<float>,
                                               const core::Progress&,
                                               std::size_t);
template void backproject_confocal_grid<double>(const ConfocalGrid<double>&,
                                                const VolumeAxes&,
                                                std::span<double>,
                                                const core::Progress&,
                                                std::size_t);

}  // namespace nlos
