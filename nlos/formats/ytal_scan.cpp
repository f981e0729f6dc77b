// SPDX-License-Identifier: MIT
#include "nlos/formats/capture_array_reader.h"
#include "nlos/formats/capture_format.h"
#include "nlos/formats/ytal_layout.h"
#include "nlos/layouts/layout_histograms.h"
#include "renderer/core/error.h"
#include "renderer/core/settings/settings_json.h"

#include <fmt/core.h>

#include <cmath>

namespace nlos {
namespace {

using core::Capture;
using core::Error;
using core::Vec3;
using core::WallPoints;

Vec3 read_position(const ArrayReader& file, const std::string& name) {
    return to_points(file.read_doubles(name, {3}))[0];
}

/// Positions of a grid (X, Y, 3) or list (N, 3), without normals.
WallPoints read_positions(const ArrayReader& file, const std::string& name) {
    const Shape shape = file.shape(name);
    if ((shape.size() != 2 && shape.size() != 3) || shape.back() != 3) {
        throw Error(file.where(name),
                    "has shape " + shape_text(shape),
                    "must have shape (X, Y, 3) or (N, 3)");
    }
    WallPoints points;
    points.positions = to_points(file.read_doubles(name, shape));
    if (shape.size() == 3) points.grid = {shape[0], shape[1]};
    if (points.size() == 0) {
        throw Error(file.where(name), "holds no point", "must have at least one");
    }
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (!points.positions[i].allFinite()) {
            throw Error(file.where(name),
                        fmt::format("point {} is not finite", i),
                        "must be finite numbers [m]");
        }
    }
    return points;
}

std::vector<Vec3> read_normals(const ArrayReader& file,
                               const std::string& name,
                               const Shape& shape) {
    std::vector<Vec3> normals = to_points(file.read_doubles(name, shape));
    for (Vec3& normal : normals) {
        if (normal.norm() > 0.0) normal.normalize();  // single precision leaves them slightly off
    }
    return normals;
}

/// The normals that y-tal's convention gives a wall when a file has none: z = 0 looks along +z.
std::vector<Vec3> assumed_normals(const ArrayReader& file,
                                  const std::string& name,
                                  const WallPoints& points) {
    for (const Vec3& position : points.positions) {
        if (std::abs(position.z() - points.positions[0].z()) > 1e-6) {
            throw Error(file.where(name),
                        "is missing though the wall is not parallel to z = 0",
                        "must give one normal per point");
        }
    }
    return std::vector<Vec3>(points.size(), Vec3::UnitZ());
}

void read_sensing_normals(const ArrayReader& file, WallPoints& points, Capture& capture) {
    const std::string name = "sensor_grid_normals";
    if (file.has(name)) {
        points.normals = read_normals(file, name, file.shape("sensor_grid_xyz"));
        return;
    }
    points.normals = assumed_normals(file, name, points);
    capture.notes.push_back(name + " is missing: (0, 0, 1) assumed");
}

/// Normals at the laser points; y-tal's own single-laser files hold those of the sensor grid here.
void read_illumination_normals(const ArrayReader& file,
                               const WallPoints& sensing,
                               WallPoints& points,
                               Capture& capture) {
    const std::string name = "laser_grid_normals";
    const Shape wanted = file.shape("laser_grid_xyz");
    const bool present = file.has(name);
    if (present && (file.shape(name) == wanted || points.size() > 1)) {
        points.normals = read_normals(file, name, wanted);
        return;
    }
    for (const Vec3& position : points.positions) {
        std::size_t nearest = 0;
        for (std::size_t i = 1; i < sensing.size(); ++i) {
            if ((sensing.positions[i] - position).squaredNorm() <
                (sensing.positions[nearest] - position).squaredNorm()) {
                nearest = i;
            }
        }
        points.normals.push_back(sensing.normals[nearest]);
    }
    capture.notes.push_back((present ? fmt::format("{} has shape {} for shape {}",
                                                   name,
                                                   shape_text(file.shape(name)),
                                                   shape_text(wanted))
                                     : name + " is missing") +
                            ": the wall's normals are used");
}

HFormat read_h_format(const ArrayReader& file, bool lists) {
    const std::size_t rank = file.shape("H").size();
    std::int64_t format = 0;
    if (file.has("H_format")) format = file.read_integer("H_format");
    if (format >= kFirstFrequencyFormat) {
        throw Error(file.where("H_format"),
                    "says that H holds frequencies",
                    "must be a format of the time domain (T_...)");
    }
    if (format == 0 && rank == 2) return HFormat::TSi;
    if (format == 0 && rank == 3) return lists ? HFormat::TLiSi : HFormat::TSxSy;
    if (format == 0 && rank == 5) return HFormat::TLxLySxSy;
    if (format < 1 || format > 4) {
        throw Error(file.where("H_format"),
                    fmt::format("found {} for H of shape {}", format, shape_text(file.shape("H"))),
                    "must be T_Sx_Sy 1, T_Lx_Ly_Sx_Sy 2, T_Si 3 or T_Li_Si 4");
    }
    return static_cast<HFormat>(format);
}

/// The camera of an image: it stands in scene_info and both grids are null. False for scans.
bool read_camera(const ArrayReader& file, Capture& capture) {
    const bool has_points = file.has("sensor_grid_xyz") || file.has("laser_grid_xyz");
    if (has_points || !capture.scene_info->contains(kCameraKey)) return false;
    core::PinholeCamera camera;
    core::read_value(capture.scene_info[kCameraKey], file.where("scene_info: camera"), camera);
    core::validate(camera, file.where("scene_info: camera"));
    const Shape shape = file.shape("H");
    if (shape.size() != 3 || shape[1] != camera.width() || shape[2] != camera.height()) {
        throw Error(file.where("H"),
                    "has shape " + shape_text(shape),
                    fmt::format("must have shape (T, {}, {}) as the camera's resolution says",
                                camera.width(),
                                camera.height()));
    }
    capture.scan = core::ImageScan{camera};
    return true;
}

/// Finds out how points pair up and checks that H has one histogram per pair.
void read_wall_scan(const ArrayReader& file, Capture& capture) {
    core::WallScan& scan = capture.scan.wall();
    scan.sensing = read_positions(file, "sensor_grid_xyz");
    scan.illumination = read_positions(file, "laser_grid_xyz");
    read_sensing_normals(file, scan.sensing, capture);

    const HFormat format = read_h_format(file, !scan.sensing.grid && !scan.illumination.grid);
    const bool exhaustive = format == HFormat::TLxLySxSy || format == HFormat::TLiSi;
    const bool grids = format == HFormat::TLxLySxSy || format == HFormat::TSxSy;
    if (exhaustive) {
        scan.pattern = core::ScanPattern::Exhaustive;
    } else if (are_same_points(scan.sensing, scan.illumination)) {
        scan.pattern = core::ScanPattern::Confocal;
        scan.illumination = scan.sensing;
    } else if (scan.illumination.size() == 1) {
        scan.pattern = core::ScanPattern::Single;
    } else {
        throw Error(file.where("laser_grid_xyz"),
                    fmt::format("has {} points that are not the {} sensor points",
                                scan.illumination.size(),
                                scan.sensing.size()),
                    "must be one point, the sensor points, or belong to an exhaustive H");
    }
    if (!scan.is_confocal()) {
        read_illumination_normals(file, scan.sensing, scan.illumination, capture);
    }

    Shape wanted{file.shape("H").empty() ? 0 : file.shape("H")[0]};
    const auto add_extents = [&](const WallPoints& points) {
        if (grids && points.grid)
            wanted.insert(wanted.end(), points.grid->begin(), points.grid->end());
        if (!grids) wanted.push_back(points.size());
    };
    if (exhaustive) add_extents(scan.illumination);
    add_extents(scan.sensing);
    if (file.shape("H") != wanted) {
        throw Error(file.where("H"),
                    "has shape " + shape_text(file.shape("H")),
                    "must have shape " + shape_text(wanted) + " as the grids and H_format say");
    }
}

/// Whether path lengths start and end at the devices: a flag of y-tal, a text in .npz files.
core::OplOrigin read_opl_origin(const ArrayReader& file, Capture& capture) {
    const std::string flag = "t_accounts_first_and_last_bounces";
    core::OplOrigin origin = core::OplOrigin::RelayWall;
    if (file.has("opl_origin")) {
        core::read_value(
            core::Json(file.read_text("opl_origin")), file.where("opl_origin"), origin);
    } else if (!file.has(flag)) {
        capture.notes.push_back(flag + " is missing: device segments not included");
    } else if (file.read_integer(flag) != 0) {
        origin = core::OplOrigin::Device;
    }
    return origin;
}

void read_devices(const ArrayReader& file, Capture& capture) {
    core::WallScan& scan = capture.scan.wall();
    scan.opl_origin = read_opl_origin(file, capture);
    const bool device = scan.opl_origin == core::OplOrigin::Device;
    if (device || file.has("laser_xyz")) scan.laser_position = read_position(file, "laser_xyz");
    if (device || file.has("sensor_xyz")) {
        scan.detector_position = read_position(file, "sensor_xyz");
    }
    if (!scan.laser_position.allFinite() || !scan.detector_position.allFinite()) {
        throw Error(
            file.path() + ": laser_xyz, sensor_xyz", "are not finite", "must be numbers [m]");
    }
}

}  // namespace

void read_ytal_scan(const ArrayReader& file, Capture& capture) {
    if (read_camera(file, capture)) return;  // the camera is the device
    read_wall_scan(file, capture);
    read_devices(file, capture);
}

}  // namespace nlos
