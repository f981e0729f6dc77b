// SPDX-License-Identifier: MIT
#include "nlos/compare/compare.h"
#include "nlos/compare/compare_scores.h"
#include "renderer/core/nearest_neighbours.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace nlos {
namespace {

double mean(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double share_within(const std::vector<double>& distances_m, double threshold_m) {
    const auto within = std::count_if(distances_m.begin(), distances_m.end(), [&](double distance) {
        return distance <= threshold_m;
    });
    return static_cast<double>(within) / static_cast<double>(distances_m.size());
}

}  // namespace

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t half = values.size() / 2;
    return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

double angle_deg(const core::Vec3& a, const core::Vec3& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b)) * core::kDegreesPerRadian;
}

void score_angles(const std::vector<double>& angles_deg, Metrics& metrics) {
    if (angles_deg.empty()) return;
    metrics.normal_mae_deg = mean(angles_deg);
    metrics.normal_median_deg = median(angles_deg);
}

Metrics compare_points(const core::PointCloud& result,
                       const core::PointCloud& truth,
                       double threshold_m) {
    Metrics metrics;
    if (result.positions.empty() || truth.positions.empty()) return metrics;

    const core::NearestNeighbours to_truth =
        core::nearest_neighbours(result.positions, truth.positions);
    const core::NearestNeighbours to_result =
        core::nearest_neighbours(truth.positions, result.positions);
    metrics.chamfer_m = 0.5 * (mean(to_truth.distances_m) + mean(to_result.distances_m));

    const double accuracy = share_within(to_truth.distances_m, threshold_m);
    const double completeness = share_within(to_result.distances_m, threshold_m);
    const double sum = accuracy + completeness;
    metrics.fscore = sum > 0.0 ? 2.0 * accuracy * completeness / sum : 0.0;
    metrics.completeness = completeness;
    metrics.accuracy = accuracy;
    metrics.fscore_threshold_m = threshold_m;

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

}  // namespace nlos
