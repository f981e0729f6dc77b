// SPDX-License-Identifier: MIT
// Scans of unusual shape. One point, few points and one line for every reconstruction method:
// tests/nlos/reconstruction_hard_cases_test.cpp.
#include "nlos/preparation/wall_frame.h"
#include "renderer/core/nearest_neighbours.h"
#include "renderer/core/random.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/render.h"
#include "tests/hard_cases/cases.h"
#include "tests/hard_cases/extended_precision.h"
#include "tests/hard_cases/hard_case.h"
#include "tests/nlos/methods/confocal_scene.h"
#include "tests/support/random_geometry.h"
#include "tests/support/statistics.h"
#include "tests/support/test_scenes.h"

#include <algorithm>

namespace hard_cases {
namespace {

using core::Vec3;
using truth::Quad;
using truth::QuadVec;

constexpr double kWallAlbedo = 0.8;
constexpr double kAlbedo = 0.5;

core::Transform turned_pose(const Vec3& translation) {
    core::Transform pose = core::Transform::Identity();
    pose.translate(translation);
    pose.rotate(Eigen::AngleAxisd(2.1, Vec3(0.3, 1.0, -0.2).normalized()));
    return pose;
}

// Third bounce of a patch so small that it is a point: section 8.3 of the design.
Quad light_of_patch(const core::WallScan& scan,
                    std::size_t pair,
                    const Vec3& position,
                    const Vec3& normal,
                    double area_m2) {
    const auto segment = [&](const core::WallPoints& points, std::size_t index) {
        const QuadVec d = QuadVec(position) - QuadVec(points.positions[index]);
        const Quad r2 = d.dot(d);
        const Quad cosine = QuadVec(points.normals[index]).dot(d);
        return cosine > 0 ? cosine * truth::abs(QuadVec(normal).dot(d)) / (r2 * r2) : Quad(0);
    };
    const Quad pi = truth::pi();
    return Quad(kWallAlbedo) * Quad(kWallAlbedo) * Quad(kAlbedo) / (pi * pi * pi) * Quad(area_m2) *
           segment(scan.illumination, scan.illumination_index(pair)) *
           segment(scan.sensing, scan.sensing_index(pair));
}

// Worst error over all pairs of a scan of a patch of 0.2 mm.
double patch_error(const core::WallScan& scan) {
    const Vec3 position(0.1, -0.05, 1.0);
    const Vec3 u = 2e-4 * Vec3(1.0, 0.1, 0.3);
    const Vec3 v = 2e-4 * Vec3(-0.2, 1.0, -0.1);
    renderer::SceneGeometry geometry;
    geometry.objects = {
        test_support::parallelogram_object({position - 0.5 * (u + v), u, v, kAlbedo})};
    renderer::RelayWall wall;
    wall.albedo = kWallAlbedo;
    wall.center_m = Vec3(0, 0, -50);  // the points carry themselves
    const renderer::Scene scene(std::move(geometry), scan, wall);
    renderer::RenderSettings settings;
    settings.method = renderer::Estimator::ThirdBounce;
    settings.target_error = 1e-3;
    settings.by_order = true;  // order 2 goes straight between points of a bowl
    const core::TimeAxis axis{0.0, 8.0, 1};
    const auto result = renderer::render(scene, scan, axis, settings, {});
    const auto third = std::ranges::find(result.capture.orders, 3) - result.capture.orders.begin();
    const core::Transient& light = result.capture.by_order[static_cast<std::size_t>(third)];
    const Vec3 area_vector = u.cross(v);
    Worst worst;
    for (std::size_t pair = 0; pair < scan.num_pairs(); ++pair) {
        const Quad expected =
            light_of_patch(scan, pair, position, area_vector.normalized(), area_vector.norm());
        worst.add(truth::relative_error(light.histogram(pair)[0], expected));
    }
    return worst.value();
}

}  // namespace

double wall_frame_far_from_the_origin() {
    Worst worst;
    for (const double away : {1.0, 1e3, 1e5}) {
        const core::Transform pose = turned_pose(away * Vec3(0.6, -0.7, 0.4));
        core::WallScan scan;
        scan.sensing = scan.illumination = nlos_test::wall_grid({16, 24}, {0.06, 0.04}, pose);
        const nlos::WallFrame wall = nlos::derive_wall_frame(scan);
        worst.add(wall.grid ? std::abs(wall.grid->pitch_m[0] / 0.06 - 1.0) : HUGE_VAL);
        worst.add(wall.grid ? std::abs(wall.grid->pitch_m[1] / 0.04 - 1.0) : HUGE_VAL);
        // The frame may turn about its normal by half turns: compare normals and x up to sign.
        const core::Mat3 found = wall.world_from_wall.linear();
        for (const int axis : {0, 2}) {
            worst.add(found.col(axis).cross(pose.linear().col(axis)).norm());
        }
        worst.add((wall.world_from_wall.translation() - pose.translation()).norm());
    }
    return worst.value();
}

double wall_frames_of_points_lines_and_duplicates() {
    Worst worst;
    const core::Transform pose = turned_pose(Vec3(3.0, -2.0, 1.5));
    std::vector<core::WallPoints> shapes{nlos_test::wall_grid({1, 1}, {1.0, 1.0}, pose),
                                         nlos_test::wall_grid({12, 1}, {0.05, 1.0}, pose),
                                         nlos_test::wall_grid({1, 12}, {1.0, 0.05}, pose),
                                         nlos_test::wall_grid({12, 1}, {0.05, 1.0}, pose),
                                         nlos_test::wall_grid({3, 3}, {0.0, 0.0}, pose),
                                         nlos_test::wall_grid({4, 4}, {1e-9, 1e-9}, pose)};
    shapes[3].grid.reset();
    for (const core::WallPoints& points : shapes) {
        core::WallScan scan;
        scan.sensing = scan.illumination = points;
        const nlos::WallFrame wall = nlos::derive_wall_frame(scan);
        const core::Mat3 axes = wall.world_from_wall.linear();
        worst.add((axes.transpose() * axes - core::Mat3::Identity()).norm());
        worst.add(std::abs(axes.determinant() - 1.0));
        worst.add(axes.col(2).dot(pose.linear().col(2)) > 0.5 ? 0.0 : HUGE_VAL);
        for (const Vec3& position : points.positions) {
            worst.add(std::abs((wall.world_from_wall.inverse() * position).z()));
        }
    }
    return worst.value();
}

double light_on_curved_and_irregular_walls() {
    core::Rng rng(test_support::seed_of("light_on_curved_and_irregular_walls"), 0, 0);
    // Points on a bowl of 2 m radius, with its normals, each of them twice; then all pairs.
    std::vector<Vec3> positions;
    const Vec3 middle(0.0, 0.0, 2.0);
    for (int i = 0; i < 6; ++i) {
        const Vec3 aside = test_support::random_point(rng);
        positions.push_back(middle - 2.0 * Vec3(aside.x(), aside.y(), 2.5).normalized());
    }
    positions.insert(positions.end(), positions.begin(), positions.end());
    Worst worst;
    for (core::WallScan scan : {test_support::confocal_scan(positions),
                                test_support::confocal_scan({positions[5]}),
                                test_support::single_scan(positions[3], positions),
                                test_support::exhaustive_scan(positions, positions)}) {
        for (core::WallPoints* points : {&scan.sensing, &scan.illumination}) {
            for (std::size_t i = 0; i < points->size(); ++i) {
                points->normals[i] = (0.5 * (middle - points->positions[i])).normalized();
            }
        }
        worst.add(patch_error(scan));
    }
    return worst.value();
}

double a_point_seen_from_duplicates_and_lists() {
    // Backprojection from irregular points: each twice, the volume is twice as bright.
    core::Rng rng(test_support::seed_of("a_point_seen_from_duplicates_and_lists"), 0, 0);
    core::WallPoints once;
    for (int i = 0; i < 80; ++i) {
        once.positions.emplace_back(rng.uniform() - 0.5, rng.uniform() - 0.5, 0.0);
        once.normals.emplace_back(0.0, 0.0, 1.0);
    }
    core::WallPoints twice = once;
    twice.positions.insert(twice.positions.end(), once.positions.begin(), once.positions.end());
    twice.normals.insert(twice.normals.end(), once.normals.begin(), once.normals.end());
    const auto volume_of = [](const core::WallPoints& points) {
        core::Capture capture = nlos_test::confocal_capture(points, {0.0, 0.016, 144});
        nlos_test::add_scatterer(capture, Vec3(0.05, -0.1, 0.6), 4.0);
        nlos::ReconstructSettings settings;
        for (const char* text :
             {"method=bp", "volume.voxels=[16,16,40]", "volume.z_range_m=[0.4,0.8]"}) {
            core::apply_override(settings, text);
        }
        return nlos::reconstruct(capture, settings, {});
    };
    const nlos::Reconstruction single = volume_of(once);
    const nlos::Reconstruction doubled = volume_of(twice);
    const float most = *std::ranges::max_element(single.volume.values);
    Worst worst;
    for (std::size_t i = 0; i < single.volume.values.size(); ++i) {
        worst.add(std::abs(doubled.volume.values[i] - 2.0F * single.volume.values[i]) / most);
    }
    const Vec3 off = nlos_test::brightest_point(doubled) - Vec3(0.05, -0.1, 0.6);
    worst.add(off.norm() < 0.07 ? 0.0 : HUGE_VAL);
    return worst.value();
}

double neighbours_of_duplicate_points() {
    core::Rng rng(test_support::seed_of("neighbours_of_duplicate_points"), 0, 0);
    std::vector<Vec3> points(40, Vec3(1.0, 2.0, 3.0));
    for (int i = 0; i < 40; ++i) points.push_back(test_support::random_point(rng));
    const core::NearestNeighbours found = core::nearest_neighbours(points, points, 4);
    Worst worst;
    for (std::size_t i = 0; i < points.size(); ++i) {
        std::vector<double> expected;
        for (const Vec3& point : points) {
            expected.push_back(truth::to_double((QuadVec(point) - QuadVec(points[i])).norm()));
        }
        std::sort(expected.begin(), expected.end());
        for (std::size_t k = 0; k < 4; ++k) {
            worst.add(truth::relative_error(found.distances_m[4 * i + k], expected[k], 1));
        }
    }
    return worst.value();
}

}  // namespace hard_cases
