// SPDX-License-Identifier: MIT
#include "nlos/reconstruction/surface.h"

#include "nlos/reconstruction/column_peak.h"
#include "nlos/reconstruction/depth_sigma.h"
#include "nlos/reconstruction/surface_probability.h"
#include "renderer/core/system/parallel.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <span>

namespace nlos {
namespace {

using core::Vec3;

/// Depth at a position between evenly spaced voxel centres.
double depth_at(const VolumeAxes& axes, double position) {
    return axes.z_m.front() + position * axes.z_step_m();
}

/// Normal in the wall's frame, towards the wall, of the plane z = a x + b y + c through the
/// foreground columns around (ix, iy) that continue its surface.
Vec3 fitted_normal(const core::DepthMap& depth, std::size_t ix, std::size_t iy) {
    constexpr std::size_t kReach = 2;
    constexpr double kSteepest = 4.0;  // a larger slope is another surface
    const double z = depth.depth_m[depth.index(ix, iy)];
    core::Mat3 lhs = 1e-9 * core::Mat3::Identity();
    Vec3 rhs = Vec3::Zero();
    double scale = 0.0;
    visit_near(depth, ix, iy, kReach, [&](std::size_t jx, std::size_t jy) {
        const double dx = depth.x_m[jx] - depth.x_m[ix];
        const double dy = depth.y_m[jy] - depth.y_m[iy];
        const double dz = depth.depth_m[depth.index(jx, jy)] - z;
        const double distance = std::hypot(dx, dy);
        if (std::abs(dz) > kSteepest * distance) return;
        if (scale == 0.0) scale = distance;
        const Vec3 row(dx / std::max(scale, 1e-12), dy / std::max(scale, 1e-12), 1.0);
        lhs += row * row.transpose();
        rhs += row * dz;
    });
    if (scale == 0.0) return -Vec3::UnitZ();
    const Vec3 plane = lhs.ldlt().solve(rhs) / scale;
    return Vec3(plane.x(), plane.y(), -1.0).normalized();
}

/// What noise cannot explain of a column: its brightest voxel that noise alone would exceed in a
/// thousandth of all columns; where there is none, the one that noise explains least. Far noise
/// that falloff has raised may be brighter.
std::size_t surface_voxel(std::span<const float> column,
                          const VolumeNoise& noise,
                          double significant) {
    std::size_t brightest = column.size();
    std::size_t least_explained = 0;
    double largest = 0.0;
    for (std::size_t iz = 0; iz < column.size(); ++iz) {
        const double significance = noise.significance(brightness_of(column[iz]), iz);
        if (significance > largest) {
            largest = significance;
            least_explained = iz;
        }
        if (significance < significant) continue;
        if (brightest == column.size() || column[iz] > column[brightest]) brightest = iz;
    }
    return brightest < column.size() ? brightest : least_explained;
}

std::size_t brightest_voxel(std::span<const float> column) {
    return static_cast<std::size_t>(std::ranges::find(column, brightest_value(column)) -
                                    column.begin());
}

double significant(const VolumeNoise& noise) {
    constexpr double kChance = 1e-3;
    return noise.significance_of_chance(kChance);
}

/// The peak of every column.
std::vector<ColumnPeak> find_peaks(const Volume& volume, const std::optional<VolumeNoise>& noise) {
    const std::size_t nz = volume.axes.z_m.size();
    const double least = noise ? significant(*noise) : 0.0;
    std::vector<ColumnPeak> peaks(volume.values.size() / nz);
    core::parallel_for(peaks.size(), [&](std::size_t i) {
        const std::span<const float> column(volume.values.data() + i * nz, nz);
        peaks[i] = find_peak(
            column, noise ? surface_voxel(column, *noise, least) : brightest_voxel(column));
    });
    return peaks;
}

/// The first peak before a voxel that has a fraction of its brightness, and after which brightness
/// falls to half, so that it is no part of the same peak; else the voxel.
std::size_t front_voxel(std::span<const float> column, std::size_t voxel, double fraction) {
    constexpr float kDip = 0.5F;
    const auto least = static_cast<float>(fraction * column[voxel]);
    std::size_t highest = 0;
    while (highest < voxel && column[highest] < least) ++highest;
    for (std::size_t i = highest; i < voxel; ++i) {
        if (column[i] > column[highest]) highest = i;
        if (column[i] < kDip * column[highest]) return highest;
    }
    return voxel;
}

/// Takes the peaks of what hides those of foreground columns, as far as it is as bright as the
/// dimmest of these and noise does not explain it.
void come_to_front(const Volume& volume,
                   const std::optional<VolumeNoise>& noise,
                   double fraction,
                   const std::vector<std::size_t>& foreground,
                   std::vector<ColumnPeak>& peaks) {
    const std::size_t nz = volume.axes.z_m.size();
    const auto column_of = [&](std::size_t i) {
        return std::span<const float>(volume.values.data() + i * nz, nz);
    };
    const double significance = noise ? significant(*noise) : 0.0;
    double dimmest = std::numeric_limits<double>::infinity();
    for (const std::size_t i : foreground) {
        dimmest = std::min(dimmest, brightness_of(column_of(i)[peaks[i].voxel]));
    }
    for (const std::size_t i : foreground) {
        const std::size_t front = front_voxel(column_of(i), peaks[i].voxel, fraction);
        const double brightness = brightness_of(column_of(i)[front]);
        if (brightness < dimmest) continue;
        if (noise && noise->significance(brightness, front) < significance) continue;
        if (front != peaks[i].voxel) peaks[i] = find_peak(column_of(i), front);
    }
}

/// Voxels on either side of its peak that a surface of such a slope crosses in a column.
std::size_t reach_of(const VolumeAxes& axes, double slope) {
    if (axes.z_m.size() < 2 || axes.x_m.size() < 2) return 0;
    const double pitch_m = axes.x_m[1] - axes.x_m[0];
    return static_cast<std::size_t>(std::lround(0.5 * slope * pitch_m / axes.z_step_m()));
}

double brightness_around(std::span<const float> column, std::size_t voxel, std::size_t reach) {
    double sum = 0.0;
    const std::size_t end = std::min(column.size(), voxel + reach + 1);
    for (std::size_t i = voxel - std::min(voxel, reach); i < end; ++i) {
        sum += brightness_of(column[i]);
    }
    return sum;
}

/// The probability that every column's peak is no noise, and that it is a surface.
std::vector<double> surface_probabilities(const Volume& volume,
                                          const std::vector<ColumnPeak>& peaks,
                                          const VolumeErrors& errors,
                                          const std::optional<VolumeNoise>& noise) {
    const std::size_t nz = volume.axes.z_m.size();
    const std::size_t reach = reach_of(volume.axes, errors.steepest);
    std::vector<double> brightness;
    std::vector<double> chances;
    for (std::size_t i = 0; i < peaks.size(); ++i) {
        const std::span<const float> column(volume.values.data() + i * nz, nz);
        const double value = brightness_of(column[peaks[i].voxel]);
        brightness.push_back(brightness_around(column, peaks[i].voxel, reach));
        if (!noise) continue;
        chances.push_back(noise->chance_in_column(noise->significance(value, peaks[i].voxel)));
    }
    std::vector<double> probabilities(peaks.size(), 1.0);
    if (noise) {
        std::ranges::transform(false_discovery_rates(chances),
                               probabilities.begin(),
                               [](double rate) { return 1.0 - rate; });
    }
    std::ranges::transform(
        probabilities,
        plateau_probabilities(brightness, probabilities, volume.axes.y_m.size(), errors.plateau),
        probabilities.begin(),
        std::multiplies<>());
    return probabilities;
}

void fit_normals(core::DepthMap& depth) {
    for (std::size_t ix = 0; ix < depth.x_m.size(); ++ix) {
        for (std::size_t iy = 0; iy < depth.y_m.size(); ++iy) {
            const std::size_t i = depth.index(ix, iy);
            if (!depth.is_foreground(i)) continue;
            depth.normals[i] = depth.world_from_wall.linear() * fitted_normal(depth, ix, iy);
        }
    }
}

}  // namespace

Surface find_surface(const Volume& volume,
                     const Volume* again,
                     const VolumeErrors& errors,
                     double mask_threshold) {
    const VolumeAxes& axes = volume.axes;
    Surface surface;
    surface.depth = core::DepthMap(axes.x_m, axes.y_m);
    surface.depth.world_from_wall = axes.world_from_wall;
    surface.depth.normals.assign(surface.depth.depth_m.size(), Vec3::Zero());
    if (volume.values.empty()) return surface;

    std::optional<VolumeNoise> noise;
    if (again) noise.emplace(volume, *again, errors.scale);
    std::vector<ColumnPeak> peaks = find_peaks(volume, noise);
    surface.probability = surface_probabilities(volume, peaks, errors, noise);
    std::vector<std::size_t> foreground;
    for (std::size_t i = 0; i < peaks.size(); ++i) {
        if (surface.probability[i] >= mask_threshold) foreground.push_back(i);
    }
    if (errors.front > 0.0) come_to_front(volume, noise, errors.front, foreground, peaks);
    for (const std::size_t i : foreground) {
        surface.depth.depth_m[i] = depth_at(axes, peaks[i].position);
    }
    fit_normals(surface.depth);
    if (noise) {
        surface.depth_sigma_m = depth_sigmas(volume, peaks, surface, *again, errors);
    }
    return surface;
}

}  // namespace nlos
