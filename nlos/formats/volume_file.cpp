// SPDX-License-Identifier: MIT
#include "nlos/formats/volume_file.h"

#include "nlos/containers/array_reader.h"
#include "nlos/containers/writers/hdf5_writer.h"
#include "nlos/formats/capture_format.h"
#include "nlos/formats/coordinates.h"
#include "renderer/core/error.h"
#include "renderer/core/settings/settings_json.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace nlos {
namespace {

using core::Error;
using core::Transform;
using core::Vec3;

constexpr const char* kPose = "world_from_wall";

using RowMajor4 = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;

void write_axis(Hdf5Writer& file,
                const std::string& name,
                const std::vector<double>& centres_m,
                const RowMajor4& pose) {
    file.write(name, {centres_m.size()}, centres_m);
    file.write_attribute(name, kPose, {4, 4}, {pose.data(), 16});
    state_coordinates(file, name, kWallPositions);
}

template <class Vectors>
void write_vectors(Hdf5Writer& file,
                   const std::string& name,
                   Shape shape,
                   const Vectors& vectors,
                   const Coordinates& coordinates) {
    std::vector<double> values;
    for (const auto& vector : vectors) values.insert(values.end(), vector.begin(), vector.end());
    shape.push_back(3);
    file.write(name, shape, values);
    state_coordinates(file, name, coordinates);
}

void write_depth(Hdf5Writer& file, const Shape& columns, const Reconstruction& reconstruction) {
    file.write("depth_m", columns, reconstruction.depth.depth_m);
    state_coordinates(file, "depth_m", kWallPositions);
    if (!reconstruction.depth_sigma_m.empty()) {
        file.write("depth_sigma_m", columns, reconstruction.depth_sigma_m);
        state_coordinates(file, "depth_sigma_m", kWallPositions);
    }
    if (!reconstruction.surface_probability.empty()) {
        file.write("surface_probability", columns, reconstruction.surface_probability);
    }
    if (!reconstruction.observed.empty()) {
        file.write("observed", columns, reconstruction.observed);
    }
}

/// What an uncertain set-up does to depths: medians as attributes, and every column's.
void write_setup(Hdf5Writer& file, const Shape& columns, const Reconstruction& reconstruction) {
    if (!reconstruction.setup) return;
    const SetupReport& report = *reconstruction.setup;
    file.create_group("setup");
    file.write("setup/depth_sigma_m", columns, report.sigma_m);
    const auto note = [&](const std::string& name, double value) {
        file.write_attribute("setup", name, {}, {&value, 1});
    };
    note("depth_sigma_setup_m", report.depth_sigma_m);
    if (report.noise_sigma_m) note("depth_sigma_noise_m", *report.noise_sigma_m);
    SetupSettings setup = reconstruction.settings.setup;
    for_each_field(setup, [&](const char* name, const std::optional<double>& sigma, const auto&) {
        note(name, sigma.value_or(0.0));
    });
}

void write_points(Hdf5Writer& file, const core::PointCloud& points) {
    const Shape shape{points.positions.size()};
    write_vectors(file, "points", shape, points.positions, kWorldPositions);
    if (points.normals.empty()) return;
    write_vectors(file, "point_normals", shape, points.normals, kWorldDirections);
}

std::vector<Vec3> read_vectors(const ArrayReader& file, const std::string& name, Shape shape) {
    shape.push_back(3);
    return to_points(file.read_doubles(name, shape));
}

/// Throws unless every value is finite.
template <class Values>
void require_finite(const ArrayReader& file, const std::string& name, const Values& values) {
    for (const auto value : values) {
        if (!std::isfinite(value)) {
            throw Error(file.where(name), fmt::format("found {}", value), "must be finite numbers");
        }
    }
}

std::vector<double> read_axis(const ArrayReader& file, const std::string& name) {
    const Shape shape = file.shape(name);
    if (shape.size() != 1 || shape[0] == 0) {
        throw Error(file.where(name), "has shape " + shape_text(shape), "must have shape (N,)");
    }
    std::vector<double> centres_m = file.read_doubles(name, shape);
    require_finite(file, name, centres_m);
    return centres_m;
}

Transform read_pose(const ArrayReader& file) {
    const auto values = file.real_attribute("x_m", kPose);
    const std::string name = std::string("x_m attribute ") + kPose;
    if (!values || values->size() != 16) {
        throw Error(file.where(name), "is missing or misshapen", "must be a (4, 4) matrix");
    }
    require_finite(file, name, *values);
    Transform pose;
    pose.matrix() = Eigen::Map<const RowMajor4>(values->data());
    return pose;
}

core::DepthMap read_depth(const ArrayReader& file, const VolumeAxes& axes) {
    core::DepthMap depth(axes.x_m, axes.y_m);
    depth.world_from_wall = axes.world_from_wall;
    depth.depth_m = file.read_doubles("depth_m", {axes.x_m.size(), axes.y_m.size()});
    for (const double value : depth.depth_m) {
        if (std::isinf(value)) {
            throw Error(file.where("depth_m"), "found inf", "must be depths, NaN for background");
        }
    }
    return depth;
}

/// What is reported of every column; nothing in files without.
std::vector<double> read_column_values(const ArrayReader& file,
                                       const std::string& name,
                                       const Shape& columns) {
    if (!file.has(name)) return {};
    return file.read_doubles(name, columns);
}

std::vector<double> read_probabilities(const ArrayReader& file, const Shape& columns) {
    std::vector<double> values = read_column_values(file, "surface_probability", columns);
    for (const double value : values) {
        if (value >= 0.0 && value <= 1.0) continue;
        throw Error(file.where("surface_probability"),
                    fmt::format("found {}", value),
                    "must be within [0, 1]");
    }
    return values;
}

std::vector<double> read_sigmas(const ArrayReader& file, const core::DepthMap& depth) {
    std::vector<double> values =
        read_column_values(file, "depth_sigma_m", {depth.x_m.size(), depth.y_m.size()});
    for (std::size_t i = 0; i < values.size(); ++i) {
        const bool is_sigma = std::isfinite(values[i]) && values[i] >= 0.0;
        if (depth.is_foreground(i) ? is_sigma : std::isnan(values[i])) continue;
        throw Error(file.where("depth_sigma_m"),
                    fmt::format("found {} at column {}", values[i], i),
                    "must be 0 or more where depth_m is a depth, NaN elsewhere");
    }
    return values;
}

core::PointCloud read_points(const ArrayReader& file) {
    core::PointCloud points;
    const Shape shape = file.shape("points");
    points.positions = read_vectors(file, "points", {shape.empty() ? 0 : shape[0]});
    for (const Vec3& position : points.positions) require_finite(file, "points", position);
    if (file.has("point_normals")) {
        points.normals = read_vectors(file, "point_normals", {points.positions.size()});
        for (const Vec3& normal : points.normals) require_finite(file, "point_normals", normal);
    }
    return points;
}

/// The normals of the points, which are the foreground columns in order.
void give_normals(const core::PointCloud& points, core::DepthMap& depth) {
    if (points.normals.empty()) return;
    depth.normals.assign(depth.depth_m.size(), Vec3::Zero());
    std::size_t next = 0;
    for (std::size_t i = 0; i < depth.depth_m.size() && next < points.normals.size(); ++i) {
        if (depth.is_foreground(i)) depth.normals[i] = points.normals[next++];
    }
}

ReconstructSettings read_settings(const ArrayReader& file) {
    ReconstructSettings settings;
    const auto text = file.text_attribute("/", "settings");
    if (!text) return settings;
    const std::string where = file.where("attribute settings");
    core::read_value(core::parse_json(*text, where), where, settings);
    return settings;
}

/// A root attribute that holds one number; 0 when missing.
double read_number(const ArrayReader& file, const std::string& name) {
    const auto values = file.real_attribute("/", name);
    if (!values) return 0.0;
    if (values->size() != 1 || !std::isfinite((*values)[0]) || (*values)[0] < 0.0) {
        throw Error(
            file.where("attribute " + name), "is no count", "must be one number, 0 or more");
    }
    return (*values)[0];
}

}  // namespace

void write_volume(const std::string& path, const Reconstruction& reconstruction) {
    const Volume& volume = reconstruction.volume;
    const VolumeAxes& axes = volume.axes;
    const Shape columns{axes.x_m.size(), axes.y_m.size()};
    const RowMajor4 pose = axes.world_from_wall.matrix();

    Hdf5Writer file(path);
    file.write("volume", {columns[0], columns[1], axes.z_m.size()}, volume.values);
    write_axis(file, "x_m", axes.x_m, pose);
    write_axis(file, "y_m", axes.y_m, pose);
    write_axis(file, "z_m", axes.z_m, pose);
    write_depth(file, columns, reconstruction);
    write_setup(file, columns, reconstruction);
    file.write("max_projection", columns, max_projection(volume));
    if (!volume.normals.empty()) {
        write_vectors(file, "normals", columns, volume.normals, kWallDirections);
    }
    write_points(file, reconstruction.points);
    file.write_attribute("/", "method", reconstruction.method);
    file.write_attribute("/", "reason", reconstruction.reason);
    file.write_guarded_attribute(
        "/", "settings", core::json_text(core::write_value(reconstruction.settings)));
    file.write_guarded_attribute("/", "provenance", core::json_text(*reconstruction.provenance));
    const auto peak_bytes = static_cast<double>(reconstruction.peak_bytes);
    file.write_attribute("/", "seconds", {}, {&reconstruction.seconds, 1});
    file.write_attribute("/", "peak_bytes", {}, {&peak_bytes, 1});
    if (reconstruction.resolution_m) {
        file.write_attribute("/", "resolution_m", {}, {&*reconstruction.resolution_m, 1});
    }
    file.finish();
}

Reconstruction read_volume(const std::string& path) {
    const ArrayReader file(path);
    Reconstruction result;
    VolumeAxes& axes = result.volume.axes;
    axes.x_m = read_axis(file, "x_m");
    axes.y_m = read_axis(file, "y_m");
    axes.z_m = read_axis(file, "z_m");
    axes.world_from_wall = read_pose(file);
    const Shape columns{axes.x_m.size(), axes.y_m.size()};
    result.volume.values = file.read_floats("volume", {columns[0], columns[1], axes.z_m.size()});
    require_finite(file, "volume", result.volume.values);
    if (file.has("normals")) {
        for (const Vec3& normal : read_vectors(file, "normals", columns)) {
            result.volume.normals.push_back(normal.cast<float>());
        }
    }
    result.depth = read_depth(file, axes);
    result.depth_sigma_m = read_sigmas(file, result.depth);
    result.surface_probability = read_probabilities(file, columns);
    result.points = read_points(file);
    give_normals(result.points, result.depth);
    result.method = file.text_attribute("/", "method").value_or("");
    result.reason = file.text_attribute("/", "reason").value_or("");
    result.settings = read_settings(file);
    const std::string made = file.text_attribute("/", "provenance").value_or("");
    if (auto provenance = core::json_if_valid(made)) result.provenance = std::move(*provenance);
    result.seconds = read_number(file, "seconds");
    result.peak_bytes =
        static_cast<std::uint64_t>(std::min(read_number(file, "peak_bytes"), 0x1p63));
    if (const double resolution_m = read_number(file, "resolution_m"); resolution_m > 0.0) {
        result.resolution_m = resolution_m;
    }
    return result;
}

bool is_volume_file(const std::string& path) {
    const auto file = open_arrays(path);
    return file && file->container() == "hdf5" && file->has("volume");
}

}  // namespace nlos
