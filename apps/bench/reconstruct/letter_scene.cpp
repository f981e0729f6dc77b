// SPDX-License-Identifier: MIT
#include "apps/bench/reconstruct/letter_scene.h"

#include "renderer/core/parallel.h"

#include <cmath>

namespace apps {
namespace {

using core::Vec3;

constexpr double kDepth_m = 0.7;
constexpr double kPatch_m = 0.012;
constexpr std::size_t kPoints = 64;

bool is_on_letter(double x, double y) {
    const bool is_stem = std::abs(x) < 0.066 && std::abs(y) < 0.306;
    const bool is_bar = std::abs(x) < 0.306 && y > 0.174 && y < 0.306;
    return is_stem || is_bar;
}

std::vector<Vec3> patches() {
    std::vector<Vec3> centres;
    for (int ix = -26; ix <= 26; ++ix) {
        for (int iy = -26; iy <= 26; ++iy) {
            const Vec3 centre(kPatch_m * ix, kPatch_m * iy, kDepth_m);
            if (is_on_letter(centre.x(), centre.y())) centres.push_back(centre);
        }
    }
    return centres;
}

core::WallPoints wall_points() {
    core::WallPoints points;
    points.grid = {kPoints, kPoints};
    for (std::size_t ix = 0; ix < kPoints; ++ix) {
        for (std::size_t iy = 0; iy < kPoints; ++iy) {
            points.positions.emplace_back((static_cast<double>(ix) + 0.5) / kPoints - 0.5,
                                          (static_cast<double>(iy) + 0.5) / kPoints - 0.5,
                                          0.0);
        }
    }
    points.normals.assign(points.size(), Vec3::UnitZ());
    return points;
}

}  // namespace

core::Capture letter_t_capture(core::ScanPattern pattern) {
    core::Capture capture;
    core::Scan& scan = capture.scan;
    scan.pattern = pattern;
    scan.sensing = wall_points();
    scan.illumination = scan.sensing;
    if (pattern == core::ScanPattern::Single) {
        scan.illumination.positions = {Vec3::Zero()};
        scan.illumination.normals = {Vec3::UnitZ()};
        scan.illumination.grid = {1, 1};
    }
    capture.time_axis = {0.0, 0.008, 512};
    capture.transient = core::Transient(scan.num_pairs(), capture.time_axis.num_bins);
    const std::vector<Vec3> letter = patches();
    core::parallel_for(scan.num_pairs(), [&](std::size_t pair) {
        const Vec3& l = scan.illumination.positions[scan.illumination_index(pair)];
        const Vec3& s = scan.sensing.positions[scan.sensing_index(pair)];
        const auto histogram = capture.transient.histogram(pair);
        for (const Vec3& patch : letter) {
            const double out = (patch - l).norm();
            const double back = (patch - s).norm();
            const double bin = (out + back) / capture.time_axis.bin_width_m - 0.5;
            const auto first = static_cast<std::size_t>(bin);
            if (first + 1 >= histogram.size()) continue;
            const double light = 1.0 / (out * out * back * back);
            const double late = bin - static_cast<double>(first);
            histogram[first] += static_cast<float>(light * (1.0 - late));
            histogram[first + 1] += static_cast<float>(light * late);
        }
    });
    return capture;
}

core::DepthMap letter_t_depth(const core::Transform& world_from_wall,
                              const std::vector<double>& x_m,
                              const std::vector<double>& y_m) {
    core::DepthMap depth(x_m, y_m);
    depth.world_from_wall = world_from_wall;
    depth.normals.assign(depth.depth_m.size(), Vec3::Zero());
    for (std::size_t ix = 0; ix < x_m.size(); ++ix) {
        for (std::size_t iy = 0; iy < y_m.size(); ++iy) {
            const Vec3 at = world_from_wall * Vec3(x_m[ix], y_m[iy], kDepth_m);
            if (!is_on_letter(at.x(), at.y())) continue;
            depth.depth_m[depth.index(ix, iy)] = kDepth_m;
            depth.normals[depth.index(ix, iy)] = -Vec3::UnitZ();
        }
    }
    return depth;
}

}  // namespace apps
