// SPDX-License-Identifier: MIT
#include "renderer/core/sensor_footprint.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace core {
namespace {

/// The sensor's rays in its own frame, and the wall that they may hit.
class Rays {
 public:
    Rays(const SensorSetup& setup, const SensorPose& pose)
        : wall_from_world_(setup.wall.world_from_wall().inverse()),
          world_from_wall_(setup.wall.world_from_wall()),
          world_from_sensor_(pose.world_from_sensor()),
          half_width_(0.5 * setup.wall.size_m[0]),
          half_height_(0.5 * setup.wall.size_m[1]) {}

    /// Where a ray meets the wall's front; nothing when it does not.
    std::optional<Vec3> hit(const Vec3& origin, const Vec2& tangents) const {
        const Vec3 from = wall_from_world_ * origin;
        const Vec3 along = wall_from_world_.linear() *
                           (world_from_sensor_ * Vec3(tangents.x(), tangents.y(), -1.0));
        if (!(from.z() > 0.0) || !(along.z() < 0.0)) return std::nullopt;
        Vec3 point = from - from.z() / along.z() * along;
        if (!(std::abs(point.x()) <= half_width_) || !(std::abs(point.y()) <= half_height_)) {
            return std::nullopt;
        }
        point.z() = 0.0;
        return world_from_wall_ * point;
    }

 private:
    Transform wall_from_world_;
    Transform world_from_wall_;
    Mat3 world_from_sensor_;
    double half_width_;
    double half_height_;
};

/// Tangents of the angles at which the zones' rectangles lie in the sensor's image.
class ZoneGrid {
 public:
    explicit ZoneGrid(const SensorModel& model)
        : columns_(model.zones[0]),
          rows_(model.zones[1]),
          half_x_(std::tan(0.5 * model.fov_deg[0] / kDegreesPerRadian)),
          half_y_(std::tan(0.5 * model.fov_deg[1] / kDegreesPerRadian)) {}

    /// column and row   from the image's top left, with fractions
    Vec2 tangents(double column, double row) const {
        return {half_x_ * (2.0 * column / columns_ - 1.0), half_y_ * (1.0 - 2.0 * row / rows_)};
    }
    double zone_area() const { return 4.0 * half_x_ * half_y_ / (columns_ * rows_); }

 private:
    int columns_;
    int rows_;
    double half_x_;
    double half_y_;
};

void add_point(const std::optional<Vec3>& point,
               const Vec3& origin,
               double weight,
               PatchPoints& points) {
    if (!point) return;
    points.positions.push_back(*point);
    points.weights.push_back(weight);
    points.device_m.push_back((*point - origin).norm());
}

void scale(double factor, std::vector<double>& values) {
    for (double& value : values) value *= factor;
}

}  // namespace

Mat3 SensorPose::world_from_sensor() const {
    Mat3 frame;
    const Vec3 view = forward.normalized();
    frame.col(0) = view.cross(up).normalized();
    frame.col(1) = frame.col(0).cross(view);
    frame.col(2) = -view;
    return frame;
}

std::size_t SensorFootprints::num_dead() const {
    return static_cast<std::size_t>(std::count_if(
        zones.begin(), zones.end(), [](const ZoneFootprint& zone) { return zone.is_dead(); }));
}

void validate(const SensorPose& pose, const std::string& where) {
    const double length = pose.forward.norm();
    require(length > 1e-9, join_key(where, "forward length"), length, "above 0");
    require(pose.up.cross(pose.forward / length).norm() > 1e-9 * (1.0 + pose.up.norm()),
            join_key(where, "up part across forward"),
            0.0,
            "above 0");
}

void validate(const SensorSetup& setup, const std::string& where) {
    check_ranges(setup, where);
    validate(setup.model, join_key(where, "model"));
    validate(setup.pose, join_key(where, "pose"));
    for (std::size_t i = 0; i < setup.poses.size(); ++i) {
        validate(setup.poses[i], fmt::format("{}[{}]", join_key(where, "poses"), i));
    }
    validate(setup.wall, join_key(where, "wall"));
}

SensorFootprints make_footprints(const SensorSetup& setup, std::size_t frame) {
    const SensorModel& model = setup.model;
    const SensorPose& pose = setup.pose_of_frame(frame);
    const Rays rays(setup, pose);
    const ZoneGrid grid(model);
    SensorFootprints result;
    result.receiver_m = pose.position_m;
    result.laser_m = pose.position_m +
                     pose.world_from_sensor() * Vec3(model.emitter_m[0], model.emitter_m[1], 0.0);
    result.normal = setup.wall.normal.normalized();
    const int n = setup.subsamples;
    double field_sr = 0.0;  // in units of a subsample's area
    double etendue = 0.0;
    for (int row = 0; row < model.zones[1]; ++row) {
        for (int column = 0; column < model.zones[0]; ++column) {
            ZoneFootprint& zone = result.zones.emplace_back();
            double zone_sr = 0.0;
            for (int j = 0; j < n; ++j) {
                for (int i = 0; i < n; ++i) {
                    const Vec2 tangents =
                        grid.tangents(column + (i + 0.5) / n, row + (j + 0.5) / n);
                    const double cosine = 1.0 / std::sqrt(1.0 + tangents.squaredNorm());
                    const double solid_angle = std::pow(cosine, 3);
                    add_point(
                        rays.hit(result.laser_m, tangents), result.laser_m, solid_angle, zone.lit);
                    add_point(rays.hit(result.receiver_m, tangents),
                              result.receiver_m,
                              solid_angle * cosine,
                              zone.seen);
                    zone_sr += solid_angle;
                    etendue += solid_angle * cosine;
                }
            }
            field_sr += zone_sr;
            if (model.illumination == SensorIllumination::Zones) {
                scale(1.0 / zone_sr, zone.lit.weights);
            }
            zone.center_m = rays.hit(result.receiver_m, grid.tangents(column + 0.5, row + 0.5));
            if (!zone.center_m && !zone.is_dead()) {
                const auto& points = zone.seen.positions;
                zone.center_m = std::accumulate(points.begin(), points.end(), Vec3(Vec3::Zero())) /
                                static_cast<double>(points.size());
            }
        }
    }
    const double mean_etendue = etendue / model.num_zones();
    for (ZoneFootprint& zone : result.zones) {
        scale(1.0 / mean_etendue, zone.seen.weights);
        if (model.illumination == SensorIllumination::Flood) {
            scale(1.0 / field_sr, zone.lit.weights);
        }
    }
    result.zone_etendue_sr = mean_etendue * grid.zone_area() / (n * n);
    if (result.num_dead() == result.zones.size()) {
        const Vec3& p = pose.position_m;
        const Vec3& f = pose.forward;
        throw Error(fmt::format("pose of frame {}", frame),
                    fmt::format("at ({:.4g}, {:.4g}, {:.4g}) looking along ({:.4g}, {:.4g}, "
                                "{:.4g}) no zone sees the relay wall",
                                p.x(),
                                p.y(),
                                p.z(),
                                f.x(),
                                f.y(),
                                f.z()),
                    "must look at the wall's front");
    }
    return result;
}

std::optional<SensorSetup> recorded_sensor(const Capture& capture) {
    if (!capture.scene_info.is_object()) return std::nullopt;
    const auto found = capture.scene_info.find("sensor");
    if (found == capture.scene_info.end() || !found->is_object()) return std::nullopt;
    SensorSetup setup;
    read_value(*found, "scene_info.sensor", setup);
    validate(setup, "scene_info.sensor");
    return setup;
}

}  // namespace core
