// SPDX-License-Identifier: MIT
#include "nlos/compare/compare.h"

#include "nlos/compare/compare_image.h"
#include "renderer/core/nearest_neighbours.h"
#include "renderer/core/statistics.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace nlos {
namespace {

constexpr double kMaskFraction = 0.2;
constexpr double kFixedThreshold_m = 0.01;  // the same for every grid and method

double voxel_diagonal_m(const VolumeAxes& axes) {
    return std::hypot(
        core::spacing_m(axes.x_m), core::spacing_m(axes.y_m), core::spacing_m(axes.z_m));
}

/// Throws unless both axes have the same centres, within a thousandth of their distance.
void check_same_axis(const std::vector<double>& found,
                     const std::vector<double>& wanted,
                     const std::string& name) {
    const auto refuse = [&](const std::string& difference) {
        throw core::Error("compare: " + name, difference, "both must have the same grid");
    };
    if (found.size() != wanted.size()) {
        refuse(fmt::format("found {} values against {}", found.size(), wanted.size()));
    }
    const double tolerance = 1e-6 + 1e-3 * core::spacing_m(wanted);
    for (std::size_t i = 0; i < found.size(); ++i) {
        if (std::abs(found[i] - wanted[i]) <= tolerance) continue;
        refuse(fmt::format("value {} is {} m against {} m", i, found[i], wanted[i]));
    }
}

void check_same_wall(const core::Transform& found, const core::Transform& wanted) {
    constexpr double kTolerance = 1e-6;  // of rotation entries and metres
    if (((found.affine() - wanted.affine()).array().abs() <= kTolerance).all()) return;
    throw core::Error(
        "compare: wall", "found two different poses", "both must lie in the same wall's frame");
}

/// Columns in which both maps have a depth.
std::vector<std::size_t> common_columns(const core::DepthMap& depth, const core::DepthMap& truth) {
    std::vector<std::size_t> columns;
    if (depth.depth_m.size() != truth.depth_m.size()) return columns;
    for (std::size_t i = 0; i < truth.depth_m.size(); ++i) {
        if (truth.is_foreground(i) && depth.is_foreground(i)) columns.push_back(i);
    }
    return columns;
}

Mask foreground_of(const core::DepthMap& map) {
    Mask mask(map.depth_m.size());
    for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = map.is_foreground(i);
    return mask;
}

Covered covered_of(const core::TrueSurface& truth) {
    Covered covered(truth.columns.size());
    for (std::size_t i = 0; i < covered.size(); ++i) covered[i] = truth.covered(i);
    return covered;
}

/// Overlap of the masks that a result's projection and depths give with a true one.
void score_masks(const std::vector<float>& projection,
                 const core::DepthMap& depth,
                 const Covered& truth,
                 Metrics& metrics) {
    metrics.mask_iou = mask_iou(mask_above_fraction(projection, kMaskFraction), truth);
    if (depth.depth_m.size() == truth.size()) {
        metrics.mask_iou_stated = mask_iou(foreground_of(depth), truth);
    }
    if (const auto best = best_mask(projection, truth)) {
        metrics.mask_iou_best = best->iou;
        metrics.mask_iou_best_threshold = best->fraction;
    }
}

double mean(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double fraction_within(const std::vector<double>& distances_m, double threshold_m) {
    const auto within = std::count_if(distances_m.begin(), distances_m.end(), [&](double distance) {
        return distance <= threshold_m;
    });
    return static_cast<double>(within) / static_cast<double>(distances_m.size());
}

/// Angle between two directions [deg].
double angle_deg(const core::Vec3& a, const core::Vec3& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b)) * core::kDegreesPerRadian;
}

/// Mean and median of angles between normals; leaves `metrics` alone when there are none.
void score_angles(const std::vector<double>& angles_deg, Metrics& metrics) {
    if (angles_deg.empty()) return;
    metrics.normal_mae_deg = mean(angles_deg);
    metrics.normal_median_deg = core::median(angles_deg);
}

void score_depth(const core::DepthMap& depth,
                 const core::DepthMap& truth,
                 const Covered& covered,
                 const std::vector<std::size_t>& columns,
                 Metrics& metrics) {
    if (columns.empty()) return;
    double found = 0.0;
    for (const std::size_t i : columns) found += covered[i];
    metrics.depth_coverage = found / std::accumulate(covered.begin(), covered.end(), 0.0);
    std::vector<double> errors_m;
    double sum = 0.0;
    double squares = 0.0;
    for (const std::size_t i : columns) {
        errors_m.push_back(std::abs(depth.depth_m[i] - truth.depth_m[i]));
        sum += errors_m.back();
        squares += errors_m.back() * errors_m.back();
    }
    const auto count = static_cast<double>(errors_m.size());
    metrics.depth_mae_m = sum / count;
    metrics.depth_rmse_m = std::sqrt(squares / count);
    metrics.depth_median_m = core::median(std::move(errors_m));
}

void score_normals(const Volume& volume,
                   const core::DepthMap& truth,
                   const std::vector<std::size_t>& columns,
                   Metrics& metrics) {
    if (volume.normals.size() != truth.depth_m.size() || truth.normals.empty()) return;
    const core::Mat3 world_from_wall = volume.axes.world_from_wall.linear();
    std::vector<double> angles_deg;
    for (const std::size_t i : columns) {
        const core::Vec3 normal = world_from_wall * volume.normals[i].cast<double>();
        if (!normal.allFinite() || !(normal.norm() > 0.0)) continue;
        angles_deg.push_back(angle_deg(normal, truth.normals[i]));
    }
    score_angles(angles_deg, metrics);
}

void score_image(const std::vector<float>& image,
                 const std::vector<float>& truth,
                 const VolumeAxes& axes,
                 Metrics& metrics) {
    const auto a = normalised(image);
    const auto b = normalised(truth);
    if (!a || !b) return;
    metrics.psnr_db = psnr_db(*a, *b);
    metrics.ssim = ssim(*a, *b, axes.x_m.size(), axes.y_m.size());
}

/// World position of the brightest voxel; nothing when no value is positive.
std::optional<core::Vec3> peak_world(const Volume& volume) {
    const auto it = std::max_element(volume.values.begin(), volume.values.end());
    if (it == volume.values.end() || !(*it > 0.0F)) return std::nullopt;
    const auto index = static_cast<std::size_t>(it - volume.values.begin());
    const VolumeAxes& axes = volume.axes;
    const std::size_t column = index / axes.z_m.size();
    return axes.world_from_wall * core::Vec3(axes.x_m[column / axes.y_m.size()],
                                             axes.y_m[column % axes.y_m.size()],
                                             axes.z_m[index % axes.z_m.size()]);
}

void record_cost(const Reconstruction& result, Metrics& metrics) {
    if (result.seconds > 0.0) metrics.seconds = result.seconds;
    if (result.peak_bytes > 0) metrics.peak_rss_bytes = result.peak_bytes;
}

/// The picture an eye at the wall would see: albedo of the surface, 0 in the background.
std::vector<float> albedo_image(const core::TrueSurface& truth) {
    std::vector<float> image(truth.columns.size(), 0.0F);
    for (std::size_t i = 0; i < image.size(); ++i) {
        for (const core::ColumnSurface& surface : truth.columns[i]) {
            image[i] += static_cast<float>(surface.albedo * surface.fraction);
        }
    }
    return image;
}

/// Fractions of the true and of the found surface within a distance, and their harmonic mean.
struct Matches {
    double completeness, accuracy, fscore;
};

Matches matches_within(const std::vector<double>& to_truth_m,
                       const std::vector<double>& to_result_m,
                       double threshold_m) {
    const double accuracy = fraction_within(to_truth_m, threshold_m);
    const double completeness = fraction_within(to_result_m, threshold_m);
    const double sum = accuracy + completeness;
    return {completeness, accuracy, sum > 0.0 ? 2.0 * accuracy * completeness / sum : 0.0};
}

}  // namespace

Metrics compare_points(const core::PointCloud& result,
                       const core::PointCloud& truth,
                       double threshold_m,
                       std::optional<double> resolution_m) {
    Metrics metrics;
    if (result.positions.empty() || truth.positions.empty()) return metrics;

    const core::NearestNeighbours to_truth =
        core::nearest_neighbours(result.positions, truth.positions);
    const core::NearestNeighbours to_result =
        core::nearest_neighbours(truth.positions, result.positions);
    metrics.accuracy_m = mean(to_truth.distances_m);
    metrics.chamfer_m = 0.5 * (*metrics.accuracy_m + mean(to_result.distances_m));

    const auto within = [&](double distance_m) {
        return matches_within(to_truth.distances_m, to_result.distances_m, distance_m);
    };
    const Matches matches = within(threshold_m);
    metrics.fscore = matches.fscore;
    metrics.completeness = matches.completeness;
    metrics.accuracy = matches.accuracy;
    metrics.fscore_threshold_m = threshold_m;
    metrics.fscore_10mm = within(kFixedThreshold_m).fscore;
    if (resolution_m && std::isfinite(*resolution_m)) {
        metrics.resolution_m = resolution_m;
        metrics.fscore_resolution = within(*resolution_m).fscore;
    }

    const bool both_have_normals = result.normals.size() == result.positions.size() &&
                                   truth.normals.size() == truth.positions.size();
    if (both_have_normals) {
        std::vector<double> angles_deg;
        for (std::size_t i = 0; i < result.normals.size(); ++i) {
            // Surfaces reflect on both sides: which one a mesh calls its front says nothing.
            const double angle = angle_deg(result.normals[i], truth.normals[to_truth.indices[i]]);
            angles_deg.push_back(std::min(angle, 180.0 - angle));
        }
        score_angles(angles_deg, metrics);
    }
    return metrics;
}

Metrics compare_to_truth(const Reconstruction& result,
                         const core::TrueSurface& truth,
                         std::optional<double> threshold_m) {
    const VolumeAxes& axes = result.volume.axes;
    check_same_axis(axes.x_m, truth.main.x_m, "x");
    check_same_axis(axes.y_m, truth.main.y_m, "y");
    check_same_wall(axes.world_from_wall, truth.main.world_from_wall);
    const std::vector<float> projection = max_projection(result.volume);
    const core::DepthMap nearest = core::nearest_surfaces(truth, result.depth);
    const std::vector<std::size_t> columns = common_columns(result.depth, nearest);
    const Covered covered = covered_of(truth);

    Metrics metrics = compare_points(core::dense_points(result.depth, truth.per_side),
                                     truth.samples,
                                     threshold_m.value_or(voxel_diagonal_m(axes)),
                                     result.resolution_m);
    score_depth(result.depth, nearest, covered, columns, metrics);
    score_masks(projection, result.depth, covered, metrics);
    score_normals(result.volume, nearest, columns, metrics);
    score_image(projection, albedo_image(truth), axes, metrics);
    const auto peak = peak_world(result.volume);
    if (peak && !truth.samples.positions.empty()) {
        metrics.peak_distance_m =
            core::nearest_neighbours({*peak}, truth.samples.positions).distances_m.front();
    }
    record_cost(result, metrics);
    return metrics;
}

std::optional<std::string> coarse_truth_warning(const core::TrueSurface& truth) {
    constexpr double kAccepted = 0.02;
    if (truth.lost_at_half <= kAccepted) return std::nullopt;
    return fmt::format(
        "the truth changes with its resolution: {:.0f} % of the surface is too thin for a view "
        "half as fine; a larger ground_truth.depth_resolution shows it as it is",
        100.0 * truth.lost_at_half);
}

Metrics compare_volumes(const Reconstruction& result,
                        const Reconstruction& reference,
                        std::optional<double> threshold_m) {
    const VolumeAxes& axes = reference.volume.axes;
    check_same_axis(result.volume.axes.x_m, axes.x_m, "x");
    check_same_axis(result.volume.axes.y_m, axes.y_m, "y");
    check_same_axis(result.volume.axes.z_m, axes.z_m, "z");
    check_same_wall(result.volume.axes.world_from_wall, axes.world_from_wall);
    const std::vector<float> projection = max_projection(result.volume);
    const std::vector<float> reference_projection = max_projection(reference.volume);
    const Mask reference_mask = mask_above_fraction(reference_projection, kMaskFraction);
    const Mask reference_depths = foreground_of(reference.depth);

    Metrics metrics = compare_points(result.points,
                                     reference.points,
                                     threshold_m.value_or(voxel_diagonal_m(axes)),
                                     reference.resolution_m);
    score_depth(result.depth,
                reference.depth,
                Covered(reference_depths.begin(), reference_depths.end()),
                common_columns(result.depth, reference.depth),
                metrics);
    score_masks(
        projection, result.depth, Covered(reference_mask.begin(), reference_mask.end()), metrics);
    score_image(projection, reference_projection, axes, metrics);
    const auto peak = peak_world(result.volume);
    const auto reference_peak = peak_world(reference.volume);
    if (peak && reference_peak) metrics.peak_distance_m = (*peak - *reference_peak).norm();
    metrics.rel_mse = relative_mse(result.volume.values, reference.volume.values);
    if (metrics.rel_mse) metrics.rel_l2 = std::sqrt(*metrics.rel_mse);
    record_cost(result, metrics);
    return metrics;
}

}  // namespace nlos
