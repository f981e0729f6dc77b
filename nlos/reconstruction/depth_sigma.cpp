// SPDX-License-Identifier: MIT
#include "nlos/reconstruction/depth_sigma.h"

#include "nlos/reconstruction/column_peak.h"
#include "renderer/core/types.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace nlos {
namespace {

constexpr double kOwnFraction = 0.8;       // of a depth's distance from its plane
constexpr std::size_t kPlaneReach = 2;     // columns on either side
constexpr double kFewestForPlane = 6.0;    // columns
constexpr double kUnknownRoughness = 3.0;  // voxels, where there are fewer
constexpr double kRoughest = 12.0;         // voxels, of one column among its neighbours
constexpr double kWidest = 10.0;           // voxels
constexpr std::size_t kSearched = 6;       // voxels on either side
constexpr std::size_t kPooledReach = 4;    // columns on either side
constexpr double kPriorColumns = 16.0;     // of the whole map, beside those within reach

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// A mean of positive values.
struct Mean {
    double sum = 0.0;
    double count = 0.0;

    void add(double value, double weight = 1.0) {
        sum += weight * value;
        count += weight;
    }
    double value() const { return count > 0.0 ? sum / count : 0.0; }
};

/// The mean of value(column) over the foreground columns within reach.
template <class Value>
Mean mean_near(const core::DepthMap& depth,
               std::size_t ix,
               std::size_t iy,
               std::size_t reach,
               const Value& value) {
    Mean mean;
    visit_near(depth, ix, iy, reach, [&](std::size_t jx, std::size_t jy) {
        mean.add(value(depth.index(jx, jy)));
    });
    return mean;
}

/// By how far noise of the measurement's own deviation moves a peak [voxels]: half the distance of
/// the peaks that half of all photons and the other half show, a value of which is as far below the
/// measurement's as that of the other is above. A single half's distance from the measurement would
/// be too small where noise is strong: the peak is already at the noise's.
double movement(std::span<const float> column, std::span<const float> again, std::size_t voxel) {
    const std::size_t begin = voxel - std::min(voxel, kSearched);
    const std::size_t end = std::min(column.size(), voxel + kSearched + 1);
    std::vector<float> half(end - begin);
    std::vector<float> other(end - begin);
    for (std::size_t i = 0; i < half.size(); ++i) {
        const double here = brightness_of(again[begin + i]);
        half[i] = static_cast<float>(here);
        other[i] = static_cast<float>(2.0 * brightness_of(column[begin + i]) - here);
    }
    const auto position = [](const std::vector<float>& values) {
        const auto highest = std::ranges::max_element(values) - values.begin();
        return find_peak(values, static_cast<std::size_t>(highest)).position;
    };
    return 0.5 * std::abs(position(half) - position(other));
}

/// Distance of a depth from the plane through the foreground columns around it [m]; NaN where these
/// are too few.
double off_plane_m(const core::DepthMap& depth, std::size_t ix, std::size_t iy) {
    core::Mat3 lhs = core::Mat3::Zero();
    core::Vec3 rhs = core::Vec3::Zero();
    visit_near(depth, ix, iy, kPlaneReach, [&](std::size_t jx, std::size_t jy) {
        if (jx == ix && jy == iy) return;
        const core::Vec3 row(1.0,
                             static_cast<double>(jx) - static_cast<double>(ix),
                             static_cast<double>(jy) - static_cast<double>(iy));
        lhs += row * row.transpose();
        rhs += row * depth.depth_m[depth.index(jx, jy)];
    });
    const Eigen::LDLT<core::Mat3> solver(lhs);
    constexpr double kLeastPivot = 1e-9;  // all columns on a line
    if (lhs(0, 0) < kFewestForPlane || solver.vectorD().minCoeff() < kLeastPivot) return kNone;
    return std::abs(depth.depth_m[depth.index(ix, iy)] - solver.solve(rhs).x());
}

}  // namespace

std::vector<double> depth_sigmas(const Volume& volume,
                                 const std::vector<ColumnPeak>& peaks,
                                 const Surface& surface,
                                 const Volume& again,
                                 const VolumeErrors& errors) {
    const core::DepthMap& depth = surface.depth;
    const std::size_t nz = volume.axes.z_m.size();
    const double step_m = volume.axes.z_step_m();
    std::vector<double> moved(peaks.size(), kNone);  // [voxels]
    std::vector<double> off_m(peaks.size(), kNone);
    Mean all_moved;
    for (std::size_t i = 0; i < peaks.size(); ++i) {
        if (!depth.is_foreground(i)) continue;
        moved[i] = movement({volume.values.data() + i * nz, nz},
                            {again.values.data() + i * nz, nz},
                            peaks[i].voxel);
        all_moved.add(moved[i]);
        const double off = off_plane_m(depth, i / depth.y_m.size(), i % depth.y_m.size());
        off_m[i] = std::isnan(off) ? kUnknownRoughness * step_m : off;
    }

    std::vector<double> sigmas(peaks.size(), kNone);
    for (std::size_t ix = 0; ix < depth.x_m.size(); ++ix) {
        for (std::size_t iy = 0; iy < depth.y_m.size(); ++iy) {
            const std::size_t i = depth.index(ix, iy);
            if (!depth.is_foreground(i)) continue;
            Mean movement =
                mean_near(depth, ix, iy, kPooledReach, [&](std::size_t j) { return moved[j]; });
            movement.add(all_moved.value(), kPriorColumns);
            const double noise = std::sqrt(0.5 * core::kPi) * movement.value();
            const double width = std::min(kWidest, 1.0 / std::sqrt(peaks[i].curvature));
            const double odds_against = 1.0 / surface.probability[i] - 1.0;
            const double sure =
                std::hypot(errors.noise_fraction * noise, errors.model_fraction * width);
            const Mean rough_m = mean_near(depth, ix, iy, kPlaneReach, [&](std::size_t j) {
                return std::min(off_m[j], kRoughest * step_m);
            });
            sigmas[i] = std::hypot(step_m * sure * std::hypot(1.0, errors.doubt * odds_against),
                                   kOwnFraction * off_m[i],
                                   errors.near_fraction * rough_m.value());
        }
    }
    return sigmas;
}

}  // namespace nlos
