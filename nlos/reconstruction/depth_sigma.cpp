// SPDX-License-Identifier: MIT
#include "nlos/reconstruction/depth_sigma.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace nlos {
namespace {

constexpr double kModelError = 0.35;      // voxels
constexpr std::size_t kPooledColumns = 4;         // columns
constexpr double kPriorColumns = 16.0;    // of the whole map, beside those within reach

/// Squares of slopes of noise, and of how many columns.
struct SlopePool {
    double sum = 0.0;
    double count = 0.0;

    void add(double square) {
        if (std::isnan(square)) return;
        sum += square;
        count += 1.0;
    }
    double mean() const { return count > 0.0 ? sum / count : 0.0; }
};

/// How firmly a peak stands: brightness in deviations times curvature [1 / voxels^2].
double firmness(const Volume& volume,
                std::size_t column,
                const ColumnPeak& peak,
                VolumeScale scale,
                const VolumeNoise& noise) {
    const float value = volume.values[column * volume.axes.z_m.size() + peak.voxel];
    constexpr double kFlattest = 1e-6;
    return std::max(kFlattest, peak.curvature) *
           noise.significance(amplitude_of(value, scale), peak.voxel);
}

double pooled_square(const std::vector<double>& squares,
                     const core::DepthMap& depth,
                     std::size_t ix,
                     std::size_t iy,
                     double prior) {
    SlopePool near;
    for (std::size_t jx = ix - std::min(ix, kPooledColumns);
         jx < std::min(depth.x_m.size(), ix + kPooledColumns + 1);
         ++jx) {
        for (std::size_t jy = iy - std::min(iy, kPooledColumns);
             jy < std::min(depth.y_m.size(), iy + kPooledColumns + 1);
             ++jy) {
            near.add(squares[depth.index(jx, jy)]);
        }
    }
    return (near.sum + kPriorColumns * prior) / (near.count + kPriorColumns);
}

}  // namespace

std::vector<double> depth_sigmas(const Volume& volume,
                                 const std::vector<ColumnPeak>& peaks,
                                 const core::DepthMap& depth,
                                 const Volume& again,
                                 VolumeScale scale,
                                 const VolumeNoise& noise) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    const std::size_t nz = volume.axes.z_m.size();
    std::vector<double> firm(peaks.size(), kNone);
    std::vector<double> squares(peaks.size(), kNone);
    SlopePool all;
    for (std::size_t i = 0; i < peaks.size(); ++i) {
        if (!depth.is_foreground(i)) continue;
        firm[i] = firmness(volume, i, peaks[i], scale, noise);
        const ColumnPeak moved = find_peak({again.values.data() + i * nz, nz}, peaks[i].voxel);
        squares[i] = std::pow((moved.position - peaks[i].position) * firm[i], 2);
        all.add(squares[i]);
    }
    const double step_m =
        nz > 1 ? (volume.axes.z_m.back() - volume.axes.z_m.front()) / static_cast<double>(nz - 1)
               : 0.0;
    std::vector<double> sigmas(peaks.size(), kNone);
    for (std::size_t ix = 0; ix < depth.x_m.size(); ++ix) {
        for (std::size_t iy = 0; iy < depth.y_m.size(); ++iy) {
            const std::size_t i = depth.index(ix, iy);
            if (!depth.is_foreground(i)) continue;
            const double slope = std::sqrt(pooled_square(squares, depth, ix, iy, all.mean()));
            sigmas[i] = step_m * std::hypot(firm[i] > 0.0 ? slope / firm[i] : 0.0, kModelError);
        }
    }
    return sigmas;
}

}  // namespace nlos
