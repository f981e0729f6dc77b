// SPDX-License-Identifier: MIT
#pragma once

#include "calib/third_bounce_vjp.h"
#include "tests/support/occluded_meshes.h"
#include "tests/support/statistics.h"

#include <numeric>
#include <vector>

namespace test_support {

inline constexpr core::TimeAxis kGradientAxis{0.9, 0.016, 120};

inline core::WallPoints random_wall_points(std::size_t count, core::Rng& rng) {
    std::vector<core::Vec3> positions;
    for (std::size_t i = 0; i < count; ++i) {
        const core::Vec3 p = 0.5 * random_point(rng);
        positions.emplace_back(p.x(), p.y(), 0.0);
    }
    return wall_points(positions);
}

/// All kinds of scans in turn.
inline core::WallScan random_scan(std::uint64_t kind, core::Rng& rng) {
    core::WallScan scan;
    if (kind % 4 == 0) {
        scan = confocal_scan(random_wall_points(4, rng).positions);
        scan.opl_origin = core::OplOrigin::Device;
        scan.laser_position = core::Vec3(0.3, 0.1, 0.2);
        scan.detector_position = core::Vec3(-0.1, 0.1, 0.1);
    } else if (kind % 4 == 1) {
        scan = single_scan(random_wall_points(1, rng).positions[0],
                           random_wall_points(4, rng).positions);
    } else if (kind % 4 == 2) {
        scan = exhaustive_scan(random_wall_points(2, rng).positions,
                               random_wall_points(2, rng).positions);
    } else {
        scan.sensing = scan.illumination = curved_wall_points(4, rng);
    }
    return scan;
}

inline double inner_product(const std::vector<double>& a, const std::vector<double>& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

inline std::vector<double> random_weights(std::size_t count, core::Rng& rng) {
    std::vector<double> weights(count);
    for (double& weight : weights) weight = 2.0 * rng.uniform() - 1.0;
    return weights;
}

/// A scene, and a random linear function of its histograms.
struct GradientCase {
    OccludedMesh shapes;
    core::WallScan scan;
    calib::ThirdBounceVjpSettings settings;
    std::vector<double> weights;

    explicit GradientCase(std::uint64_t number) {
        core::Rng rng(seed_of("third_bounce_vjp"), number, 0);
        shapes = random_occluded_mesh(rng);
        scan = random_scan(number, rng);
        settings.sigma_m = number % 5 == 4 ? 0.012 : 0.0;
        weights = random_weights(
            scan.num_pairs() * static_cast<std::size_t>(kGradientAxis.num_bins), rng);
    }

    calib::ThirdBounceVjp vjp(const OccludedMesh& moved) const {
        return {moved.mesh, moved.albedo, scan, kGradientAxis, settings};
    }
    double value(const OccludedMesh& moved) const {
        return inner_product(vjp(moved).histograms(), weights);
    }
    calib::MeshGradients gradients() const { return vjp(shapes).pullback(weights); }

    /// The central difference along a motion of all vertices.
    double difference(const std::vector<core::Vec3>& motion, double step) const {
        OccludedMesh above = shapes;
        OccludedMesh below = shapes;
        for (std::size_t i = 0; i < motion.size(); ++i) {
            above.mesh.vertices[i] += step * motion[i];
            below.mesh.vertices[i] -= step * motion[i];
        }
        return (value(above) - value(below)) / (2.0 * step);
    }
};

}  // namespace test_support
