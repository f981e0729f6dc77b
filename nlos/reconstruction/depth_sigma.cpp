// SPDX-License-Identifier: MIT
#include "nlos/reconstruction/depth_sigma.h"

#include "renderer/core/types.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace nlos {
namespace {

constexpr double kDoubtFactor = 12.0;  // of odds against a surface to this power
constexpr double kDoubtPower = 1.75;
constexpr double kRoughnessShare = 0.65;
constexpr std::size_t kPlaneColumns = 2;   // on either side
constexpr double kFewestForPlane = 6.0;    // columns
constexpr double kUnknownRoughness = 3.0;  // voxels, where there are fewer
constexpr std::size_t kSearched = 6;       // voxels on either side
constexpr std::size_t kPooledColumns = 4;  // columns
constexpr double kPriorColumns = 16.0;     // of the whole map, beside those within reach

/// Sizes of slopes of noise, and of how many columns. Few peaks that jump to another one must not
/// speak for all: the deviation is told from the mean size.
struct SlopePool {
    double sum = 0.0;
    double count = 0.0;

    void add(double size) {
        if (std::isnan(size)) return;
        sum += size;
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

/// By how far noise of the measurement's own deviation moves a peak [voxels]: half the distance of
/// the peaks that half of all photons and the other half show, a value of which is as far below the
/// measurement's as that of the other is above. A single half's distance from the measurement would
/// be too small where noise is strong: the peak is already at the noise's.
double movement(std::span<const float> column,
                std::span<const float> again,
                std::size_t voxel,
                VolumeScale scale) {
    const std::size_t begin = voxel - std::min(voxel, kSearched);
    const std::size_t end = std::min(column.size(), voxel + kSearched + 1);
    std::vector<float> half(end - begin);
    std::vector<float> other(end - begin);
    for (std::size_t i = 0; i < half.size(); ++i) {
        const double here = amplitude_of(again[begin + i], scale);
        half[i] = static_cast<float>(here);
        other[i] = static_cast<float>(2.0 * amplitude_of(column[begin + i], scale) - here);
    }
    const auto position = [](const std::vector<float>& values) {
        const auto highest = std::ranges::max_element(values) - values.begin();
        return find_peak(values, static_cast<std::size_t>(highest)).position;
    };
    return 0.5 * (position(half) - position(other));
}

double pooled_size(const std::vector<double>& sizes,
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
            near.add(sizes[depth.index(jx, jy)]);
        }
    }
    return (near.sum + kPriorColumns * prior) / (near.count + kPriorColumns);
}

/// Distance of a depth from the plane through the foreground columns around it [m]; NaN where these
/// are too few.
double off_plane_m(const core::DepthMap& depth, std::size_t ix, std::size_t iy) {
    core::Mat3 lhs = core::Mat3::Zero();
    core::Vec3 rhs = core::Vec3::Zero();
    for (std::size_t jx = ix - std::min(ix, kPlaneColumns);
         jx < std::min(depth.x_m.size(), ix + kPlaneColumns + 1);
         ++jx) {
        for (std::size_t jy = iy - std::min(iy, kPlaneColumns);
             jy < std::min(depth.y_m.size(), iy + kPlaneColumns + 1);
             ++jy) {
            const std::size_t j = depth.index(jx, jy);
            if ((jx == ix && jy == iy) || !depth.is_foreground(j)) continue;
            const core::Vec3 row(1.0,
                                 static_cast<double>(jx) - static_cast<double>(ix),
                                 static_cast<double>(jy) - static_cast<double>(iy));
            lhs += row * row.transpose();
            rhs += row * depth.depth_m[j];
        }
    }
    const Eigen::LDLT<core::Mat3> solver(lhs);
    constexpr double kLeastPivot = 1e-9;  // all columns on a line
    if (lhs(0, 0) < kFewestForPlane || solver.vectorD().minCoeff() < kLeastPivot) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    return std::abs(depth.depth_m[depth.index(ix, iy)] - solver.solve(rhs).x());
}

}  // namespace

std::vector<double> depth_sigmas(const Volume& volume,
                                 const std::vector<ColumnPeak>& peaks,
                                 const Surface& surface,
                                 const Volume& again,
                                 const VolumeErrors& errors,
                                 const VolumeNoise& noise) {
    const core::DepthMap& depth = surface.depth;
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    const std::size_t nz = volume.axes.z_m.size();
    std::vector<double> firm(peaks.size(), kNone);
    std::vector<double> sizes(peaks.size(), kNone);
    SlopePool all;
    for (std::size_t i = 0; i < peaks.size(); ++i) {
        if (!depth.is_foreground(i)) continue;
        firm[i] = firmness(volume, i, peaks[i], errors.scale, noise);
        const double moved = movement({volume.values.data() + i * nz, nz},
                                      {again.values.data() + i * nz, nz},
                                      peaks[i].voxel,
                                      errors.scale);
        sizes[i] = std::abs(moved) * firm[i];
        all.add(sizes[i]);
    }
    const double step_m =
        nz > 1 ? (volume.axes.z_m.back() - volume.axes.z_m.front()) / static_cast<double>(nz - 1)
               : 0.0;
    std::vector<double> sigmas(peaks.size(), kNone);
    for (std::size_t ix = 0; ix < depth.x_m.size(); ++ix) {
        for (std::size_t iy = 0; iy < depth.y_m.size(); ++iy) {
            const std::size_t i = depth.index(ix, iy);
            if (!depth.is_foreground(i)) continue;
            const double slope =
                std::sqrt(0.5 * core::kPi) * pooled_size(sizes, depth, ix, iy, all.mean());
            const double odds_against = 1.0 / surface.probability[i] - 1.0;
            const double factor = 1.0 + kDoubtFactor * std::pow(odds_against, kDoubtPower);
            const double moved = firm[i] > 0.0 ? slope / firm[i] : 0.0;
            const double off_plane = off_plane_m(depth, ix, iy);
            const double rough_m = std::isnan(off_plane) ? kUnknownRoughness * step_m : off_plane;
            sigmas[i] = std::hypot(step_m * factor * errors.noise_share * moved,
                                   step_m * factor * errors.model_voxels,
                                   kRoughnessShare * rough_m);
        }
    }
    return sigmas;
}

}  // namespace nlos
