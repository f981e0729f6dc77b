// SPDX-License-Identifier: MIT
#include "renderer/scene/scene_file.h"

#include "renderer/core/process.h"
#include "renderer/core/settings_json.h"
#include "renderer/gltf/gltf.h"
#include "renderer/scene/sensor_settings.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <limits>

namespace renderer {
namespace {

using core::Error;
using core::require;
using core::Vec3;

void validate_geometry(const SceneDescription& scene, const std::string& where) {
    const auto refuse = [&](const char* key) {
        throw Error(where + key,
                    scene.geometry.empty()
                        ? "found without geometry"
                        : "found together with " +
                              std::filesystem::path(scene.geometry).filename().string(),
                    "must stand beside an .obj, .ply or .stl file; glTF is in metres, with y up");
    };
    if (!is_mesh_file(scene.geometry)) {
        if (scene.geometry_unit_m) refuse("geometry_unit_m");
        if (scene.geometry_up) refuse("geometry_up");
    }
    if (scene.geometry_unit_m) {
        core::check_range(*scene.geometry_unit_m, {.low = 0.0}, where + "geometry_unit_m");
    }
    validate(scene.objects, where + "objects");
}

void require_geometry(const SceneDescription& scene, const std::string& where) {
    const auto has_mesh = [](const auto& entry) { return entry.second.mesh.has_value(); };
    if (!scene.geometry.empty() ||
        std::any_of(scene.objects.begin(), scene.objects.end(), has_mesh)) {
        return;
    }
    throw Error(where + "geometry",
                "found nothing",
                "must name a .glb, .gltf, .obj, .ply or .stl file, unless objects have meshes");
}

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

void validate_scan(const ScanSettings& scan, const std::string& where) {
    core::check_ranges(scan, where);
    validate_sensor(scan, where);
    if (scan.pattern.of_sensor) return;
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

// Refuses scans whose histograms alone could not be held, before anything is allocated.
void validate_size(const SceneDescription& scene, const std::string& where) {
    const ScanSettings& scan = scene.scan;
    const auto count = [](const std::vector<Vec3>& points, const std::array<int, 2>& shape) {
        return points.empty() ? static_cast<double>(shape[0]) * shape[1]
                              : static_cast<double>(points.size());
    };
    double pairs = count(scan.sensing_points_m, scan.sensing_points);
    if (scan.pattern.of_sensor) {
        pairs = scan.sensor->num_zones();
    } else if (scene.camera) {
        pairs = static_cast<double>(scene.camera->num_pixels());
    } else if (scan.pattern == core::ScanPattern::Exhaustive) {
        pairs *= count(scan.illumination_points_m, scan.illumination_points);
    }
    const double available = static_cast<double>(core::available_memory_bytes());
    const auto& [columns, rows] = scene.ground_truth.depth_resolution;
    const double depth_map_bytes = sizeof(double) * static_cast<double>(columns) * rows;
    if (depth_map_bytes > available) {
        throw Error(where + "ground_truth.depth_resolution",
                    fmt::format("found {} x {}", columns, rows),
                    fmt::format("must fit into {:.1f} GB of memory", available * 1e-9));
    }
    double values = pairs * scene.time_axis.num_bins * (scene.frames ? scene.frames->count : 1);
    if (scene.velocity_axis) {
        const double time_bins = scene.velocity_axis->with_time ? scene.time_axis.num_bins : 1.0;
        const double per_pair = scene.velocity_axis->num_bins * time_bins;
        require(per_pair <= std::numeric_limits<int>::max(),
                where + "velocity_axis with_time: values per pair",
                per_pair,
                fmt::format("at most {}", std::numeric_limits<int>::max()));
        values += pairs * per_pair;
    }
    if (values * sizeof(float) > available) {
        throw Error(where + (scene.camera ? "camera.resolution" : "scan.sensing_points") +
                        " and time_axis.num_bins",
                    fmt::format("found {:.3g} values in all", values),
                    fmt::format("must fit into {:.1f} GB of memory", available * 1e-9));
    }
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

// Takes pose and angle of view from the glTF camera that is named, if any is.
void look_up_camera(const std::string& where, SceneDescription& scene) {
    if (!scene.camera || scene.camera->name.empty()) return;
    CameraSettings& camera = *scene.camera;
    if (scene.geometry.empty() || is_mesh_file(scene.geometry)) {
        throw Error(
            where, "found \"" + camera.name + "\"", "must be an object: the geometry is no glTF");
    }
    std::string known;
    for (const Camera& candidate : load_gltf(scene.geometry).cameras) {
        known += (known.empty() ? "" : ", ") + candidate.name;
        if (candidate.name != camera.name && candidate.lens_name != camera.name) continue;
        camera.position_m = candidate.position;
        camera.look_at_m = candidate.position + candidate.forward;
        camera.up = candidate.up;
        camera.fov_y_deg = candidate.fov_y_rad * core::kDegreesPerRadian;
        return;
    }
    throw Error(where,
                fmt::format("found \"{}\"", camera.name),
                known.empty() ? scene.geometry + " must have perspective cameras"
                              : "must be one of " + known);
}

// A camera measures instead of wall and scan; a file that names both means something else.
void refuse_two_setups(const core::Json& keys, const std::string& where) {
    if (!keys.contains("camera") || keys["camera"].is_null()) return;
    for (const char* other : {"relay_wall", "scan"}) {
        if (!keys.contains(other)) continue;
        throw Error(where + "camera",
                    fmt::format("found together with {}", other),
                    "must stand instead of relay_wall and scan");
    }
}

}  // namespace

void read_value(const core::Json& json, const std::string& where, SceneTimeAxis& axis) {
    axis.automatic = json == "auto";
    if (axis.automatic) return;
    if (!json.is_object()) {
        core::throw_wrong_type(where, json, "auto, or an object with named fields");
    }
    core::read_value<SceneTimeAxis>(json, where, axis);
}

core::Json write_value(const SceneTimeAxis& axis) {
    return axis.automatic ? core::Json("auto") : core::write_value<SceneTimeAxis>(axis);
}

void read_value(const core::Json& json, const std::string& where, CameraSettings& camera) {
    if (json.is_string()) {
        camera.name = json.get<std::string>();
    } else {
        core::read_value<CameraSettings>(json, where, camera);
    }
}

SceneDescription read_scene_description(const std::string& path,
                                        const std::vector<std::string>& overrides) {
    SceneDescription scene;
    core::Json keys = core::read_json_file(path);
    core::read_value(keys, path + ": ", scene);
    const std::string folder = std::filesystem::path(path).parent_path().string();
    if (scene.scan.sensor) read_sensor(folder, path + ": scan.sensor", *scene.scan.sensor);
    for (const std::string& text : overrides) {
        core::apply_override(scene, text);
        keys.update(core::parse_override(text));
    }
    refuse_two_setups(keys, path + ": ");
    require_geometry(scene, path + ": ");
    scene.folder = folder;
    if (!scene.geometry.empty()) {
        scene.geometry = (std::filesystem::path(folder) / scene.geometry).string();
    }
    look_up_camera(path + ": camera", scene);
    look_up_sensor(folder, path + ": ", keys, scene);
    validate(scene, path + ": ");
    return scene;
}

void change_description(SceneDescription& scene, const core::Json& changes) {
    core::read_value(changes, "", scene);
    refuse_two_setups(changes, "");
    if (changes.contains("camera")) look_up_camera("camera", scene);
    look_up_sensor("", "", {{"time_axis", nullptr}}, scene);
    validate(scene, "");
}

void validate(const SceneDescription& scene, const std::string& where) {
    validate_geometry(scene, where);
    if (scene.camera) {
        core::validate(*scene.camera, where + "camera");
        require(!scene.camera->light_spot_m || scene.render.max_bounces >= 2,
                where + "render.max_bounces",
                fmt::format("{} with camera.light_spot_m", scene.render.max_bounces),
                "at least 2: the lit spot counts as a bounce");
    } else {
        core::validate(scene.relay_wall, where + "relay_wall");
        validate_scan(scene.scan, where + "scan");
    }
    if (!scene.time_axis.automatic) core::validate(scene.time_axis, where + "time_axis");
    if (scene.velocity_axis) core::validate(*scene.velocity_axis, where + "velocity_axis");
    if (scene.frames) core::check_ranges(*scene.frames, where + "frames");
    validate_poses(scene, where);
    validate(scene.render, where + "render");
    core::check_ranges(scene.ground_truth, where + "ground_truth");
    validate_size(scene, where);
    require(
        scene.time_axis.num_bins == 1 || scene.render.gate == GateShape::Box,
        where + "render.gate",
        fmt::format("{} for {} bins", core::enum_name(scene.render.gate), scene.time_axis.num_bins),
        "box unless time_axis.num_bins is 1");
}

core::Scan make_scan(const SceneDescription& scene) {
    if (scene.camera) return core::ImageScan{*scene.camera};
    if (scene.scan.pattern.of_sensor) return core::scan_of_zones(make_sensor_setup(scene));
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

void refer_to_gltf(const std::string& file_name, SceneDescription& scene) {
    scene.geometry = file_name;
    scene.geometry_unit_m.reset();
    scene.geometry_up.reset();
    scene.objects.clear();
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
