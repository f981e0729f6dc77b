// SPDX-License-Identifier: MIT
#include "renderer/scene/measurement.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

using core::require;
using core::Vec3;

void validate_normals(const std::vector<Vec3>& points,
                      const std::vector<Vec3>& normals,
                      const std::string& where) {
    require(points.size() == normals.size(),
            where,
            fmt::format("{} normals for {} points", normals.size(), points.size()),
            "one normal per point");
    for (const Vec3& normal : normals) {
        require(normal.norm() > 1e-9, where + " length", normal.norm(), "above 0");
    }
}

void validate_wall_scan(const SceneDescription& scene, const std::string& prefix) {
    const ScanSettings& scan = scene.scan;
    const std::string where = prefix + "scan";
    validate_wall(scene, prefix);
    const char* key = scan.sensor ? "sensor" : scan.pose ? "pose" : "poses";
    require(!scan.sensor && !scan.pose && scan.poses.empty(),
            fmt::format("{}.{}", where, key),
            fmt::format("a value with pattern {}", core::enum_name(scan.pattern.pattern)),
            "left out, or pattern be sensor");
    validate_normals(scan.sensing_points_m, scan.sensing_normals, where + ".sensing_normals");
    validate_normals(
        scan.illumination_points_m, scan.illumination_normals, where + ".illumination_normals");
    const std::size_t num_lit = scan.illumination_points_m.size();
    require(scan.pattern != core::ScanPattern::Single || num_lit <= 1,
            where + ".illumination_points_m",
            static_cast<double>(num_lit),
            "one point for a single scan");
    require(scan.pattern != core::ScanPattern::Confocal || num_lit == 0,
            where + ".illumination_points_m",
            "points for a confocal scan",
            "left out: the sensing points are lit");
    require(scan.opl_origin != core::OplOrigin::Device || (scan.laser_m && scan.detector_m),
            where + ".opl_origin",
            "device without laser_m and detector_m",
            "relay_wall, or both positions given");
}

core::WallPoints wall_grid(const RelayWall& wall, const std::array<int, 2>& shape) {
    const core::Transform world_from_wall = wall.world_from_wall();
    core::WallPoints points;
    points.grid = {static_cast<std::size_t>(shape[0]), static_cast<std::size_t>(shape[1])};
    for (int ix = 0; ix < shape[0]; ++ix) {
        for (int iy = 0; iy < shape[1]; ++iy) {
            const double x = wall.size_m[0] * ((ix + 0.5) / shape[0] - 0.5);
            const double y = wall.size_m[1] * ((iy + 0.5) / shape[1] - 0.5);
            points.positions.push_back(world_from_wall * Vec3(x, y, 0.0));
        }
    }
    points.normals.assign(points.positions.size(), wall.normal.normalized());
    return points;
}

core::WallPoints explicit_points(const std::vector<Vec3>& positions,
                                 const std::vector<Vec3>& normals) {
    core::WallPoints points;
    points.positions = positions;
    for (const Vec3& normal : normals) points.normals.push_back(normal.normalized());
    return points;
}

core::WallPoints illumination_points(const SceneDescription& scene,
                                     const core::WallPoints& sensing) {
    const ScanSettings& scan = scene.scan;
    if (scan.pattern == core::ScanPattern::Confocal) return sensing;
    if (!scan.illumination_points_m.empty()) {
        return explicit_points(scan.illumination_points_m, scan.illumination_normals);
    }
    if (scan.pattern == core::ScanPattern::Exhaustive) {
        return wall_grid(scene.relay_wall, scan.illumination_points);
    }
    core::WallPoints spot;
    spot.positions = {scan.illumination_m.value_or(scene.relay_wall.center_m)};
    spot.normals = {scene.relay_wall.normal.normalized()};
    spot.grid = {1, 1};
    return spot;
}

double count(const std::vector<Vec3>& points, const std::array<int, 2>& shape) {
    return points.empty() ? static_cast<double>(shape[0]) * shape[1]
                          : static_cast<double>(points.size());
}

double num_wall_pairs(const SceneDescription& scene) {
    const ScanSettings& scan = scene.scan;
    const double sensed = count(scan.sensing_points_m, scan.sensing_points);
    if (scan.pattern != core::ScanPattern::Exhaustive) return sensed;
    return sensed * count(scan.illumination_points_m, scan.illumination_points);
}

core::Scan make_wall_scan(const SceneDescription& scene) {
    core::WallScan scan;
    scan.pattern = scene.scan.pattern;
    scan.sensing = scene.scan.sensing_points_m.empty()
                       ? wall_grid(scene.relay_wall, scene.scan.sensing_points)
                       : explicit_points(scene.scan.sensing_points_m, scene.scan.sensing_normals);
    scan.illumination = illumination_points(scene, scan.sensing);
    scan.opl_origin = scene.scan.opl_origin;
    scan.laser_position = scene.scan.laser_m.value_or(Vec3::Zero());
    scan.detector_position = scene.scan.detector_m.value_or(Vec3::Zero());
    return scan;
}

}  // namespace

const Measurement& wall_measurement() {
    static const Measurement row{
        "scan.sensing_points", validate_wall_scan, num_wall_pairs, make_wall_scan};
    return row;
}

void describe_scan(const core::WallScan& scan, ScanSettings& settings) {
    settings.pattern = scan.pattern;
    settings.sensing_points_m = scan.sensing.positions;
    settings.sensing_normals = scan.sensing.normals;
    settings.illumination_points_m.clear();
    settings.illumination_normals.clear();
    if (!scan.is_confocal()) {
        settings.illumination_points_m = scan.illumination.positions;
        settings.illumination_normals = scan.illumination.normals;
    }
    settings.opl_origin = scan.opl_origin;
    if (scan.opl_origin == core::OplOrigin::Device) {
        settings.laser_m = scan.laser_position;
        settings.detector_m = scan.detector_position;
    }
}

bool rectangle_carries_scan(const RelayWall& wall, const core::WallScan& scan) {
    const core::Transform wall_from_world = wall.world_from_wall().inverse();
    const double tolerance = 1e-6 * (wall.size_m[0] + wall.size_m[1]);
    const auto lies_on_it = [&](const Vec3& point) {
        const Vec3 p = wall_from_world * point;
        return std::abs(p.z()) < tolerance && std::abs(p.x()) < 0.5 * wall.size_m[0] + tolerance &&
               std::abs(p.y()) < 0.5 * wall.size_m[1] + tolerance;
    };
    return std::ranges::all_of(scan.path_ends(), lies_on_it);
}

}  // namespace renderer
