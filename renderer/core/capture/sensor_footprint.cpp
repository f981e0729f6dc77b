// SPDX-License-Identifier: MIT
#include "renderer/core/capture/sensor_footprint.h"

#include "renderer/core/capture/capture.h"
#include "renderer/core/settings/settings_json.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace core {
namespace {

/// The sensor's rays in its own frame, and the wall that they may hit.
class Rays {
 public:
    Rays(const RelayWall& wall, const Mat3& world_from_sensor)
        : wall_from_world_(wall.world_from_wall().inverse()),
          world_from_wall_(wall.world_from_wall()),
          world_from_sensor_(world_from_sensor),
          half_width_(0.5 * wall.size_m[0]),
          half_height_(0.5 * wall.size_m[1]) {}

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

/// Solid angle of the rectangle between the axis and the tangents x and y [sr].
double corner_solid_angle(double x, double y) {
    return std::atan(x * y / std::sqrt(1.0 + x * x + y * y));
}

/// The same with the cosine to the axis in the integrand.
double corner_etendue(double x, double y) {
    const double a = std::sqrt(1.0 + x * x);
    const double b = std::sqrt(1.0 + y * y);
    return 0.5 * (x / a * std::atan(y / a) + y / b * std::atan(x / b));
}

/// A rectangle of the sensor's image, by the tangents of its sides.
struct ImageRectangle {
    Vec2 low;
    Vec2 high;

    Vec2 center() const { return 0.5 * (low + high); }
    bool holds(const Vec2& p) const {
        return (p.array() >= low.array()).all() && (p.array() <= high.array()).all();
    }
    double solid_angle() const { return between_corners(corner_solid_angle); }
    double etendue() const { return between_corners(corner_etendue); }

    /// Part i of n along x, j along y, of n x n equal ones, from the top left.
    ImageRectangle part(int i, int j, int columns, int rows) const {
        const Vec2 step = (high - low).cwiseQuotient(Vec2(columns, rows));
        const Vec2 corner(low.x() + i * step.x(), high.y() - (j + 1) * step.y());
        return {corner, corner + step};
    }

 private:
    template <class Integral>
    double between_corners(Integral&& integral) const {
        return integral(high.x(), high.y()) - integral(low.x(), high.y()) -
               integral(high.x(), low.y()) + integral(low.x(), low.y());
    }
};

ImageRectangle field_of(const SensorModel& model) {
    const Vec2 half(std::tan(0.5 * model.fov_deg[0] / kDegreesPerRadian),
                    std::tan(0.5 * model.fov_deg[1] / kDegreesPerRadian));
    return {-half, half};
}

void add_point(const std::optional<Vec3>& point,
               const Vec3& origin,
               double weight,
               PatchPoints& points) {
    if (!point) return;
    points.positions.push_back(*point);
    points.weights.push_back(weight);
    points.device_m.push_back((*point - origin).norm());
}

/// The laser as the wall sees it.
struct Laser {
    Vec3 position;
    Mat3 sensor_from_world;
    Vec3 wall_normal;

    /// Irradiance of the wall per watt that is spread evenly over a rectangle of the image [1/m^2].
    double irradiance(const Vec3& point, const ImageRectangle& lit) const {
        const Vec3 way = point - position;
        const Vec3 seen = sensor_from_world * way;
        if (!(seen.z() < 0.0) || !lit.holds(Vec2(seen.x(), seen.y()) / -seen.z())) return 0.0;
        const double cosine = -wall_normal.dot(way) / way.norm();
        return std::max(0.0, cosine) / (lit.solid_angle() * way.squaredNorm());
    }
};

/// Where a zone's middle looks; else the mean of what it sees.
std::optional<Vec3> center_of(const std::optional<Vec3>& middle, const PatchPoints& seen) {
    if (middle || seen.positions.empty()) return middle;
    return Vec3(std::accumulate(seen.positions.begin(), seen.positions.end(), Vec3(Vec3::Zero())) /
                static_cast<double>(seen.size()));
}

void require_any_seen(const SensorFootprints& footprints,
                      const SensorPose& pose,
                      const std::string& where) {
    if (footprints.num_dead() < footprints.zones.size()) return;
    throw Error(where,
                fmt::format("found {} looking along {}, from where no zone sees the relay wall",
                            vector_text(pose.position_m),
                            vector_text(pose.forward)),
                "must look at the front of the wall, within its size_m");
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

double zone_etendue_sr(const SensorModel& model) {
    return field_of(model).etendue() / model.num_zones();
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
    const Mat3 world_from_sensor = pose.world_from_sensor();
    const Rays rays(setup.wall, world_from_sensor);
    const ImageRectangle field = field_of(model);
    SensorFootprints result;
    result.receiver_m = pose.position_m;
    result.laser_m =
        pose.position_m + world_from_sensor * Vec3(model.emitter_m[0], model.emitter_m[1], 0.0);
    result.normal = setup.wall.normal.normalized();
    const double mean_etendue = zone_etendue_sr(model);
    const Laser laser{result.laser_m, world_from_sensor.transpose(), result.normal};
    const int n = setup.subsamples;
    for (int index = 0; index < model.num_zones(); ++index) {
        const ImageRectangle image = field.part(
            index % model.zones[0], index / model.zones[0], model.zones[0], model.zones[1]);
        const ImageRectangle& lit = model.illumination == SensorIllumination::Flood ? field : image;
        ZoneFootprint& zone = result.zones.emplace_back();
        for (int k = 0; k < n * n; ++k) {
            const ImageRectangle cell = image.part(k % n, k / n, n, n);
            add_point(rays.hit(result.laser_m, cell.center()),
                      result.laser_m,
                      cell.solid_angle() / lit.solid_angle(),
                      zone.lit);
            add_point(rays.hit(result.receiver_m, cell.center()),
                      result.receiver_m,
                      cell.etendue() / mean_etendue,
                      zone.seen);
        }
        for (const Vec3& point : zone.seen.positions) {
            zone.seen_irradiance.push_back(laser.irradiance(point, lit));
        }
        zone.center_m = center_of(rays.hit(result.receiver_m, image.center()), zone.seen);
    }
    require_any_seen(result, pose, setup.poses.empty() ? "pose" : fmt::format("poses[{}]", frame));
    return result;
}

std::vector<std::string> describe_sensor(const SensorSetup& setup) {
    const SensorModel& model = setup.model;
    const SensorPose& pose = setup.pose_of_frame(0);
    const std::size_t dead = make_footprints(setup).num_dead();
    const bool floods = model.illumination == SensorIllumination::Flood;
    return {
        fmt::format("sensor: {}, {} x {} zones over {:.4g} x {:.4g} degrees, {}, {} x {} points "
                    "per zone",
                    model.title.empty() ? model.name : model.title,
                    model.zones[0],
                    model.zones[1],
                    model.fov_deg[0],
                    model.fov_deg[1],
                    floods ? "flood light" : "each zone lights its own spot",
                    setup.subsamples,
                    setup.subsamples),
        fmt::format("sensor at {} m, looking along {}{}; {} of {} zones see the wall",
                    vector_text(pose.position_m),
                    vector_text(pose.forward.normalized()),
                    setup.poses.size() > 1
                        ? fmt::format(" in the first of {} poses", setup.poses.size())
                        : "",
                    static_cast<std::size_t>(model.num_zones()) - dead,
                    model.num_zones())};
}

SensorScan scan_of_zones(const SensorSetup& setup, std::size_t frame) {
    const SensorFootprints footprints = make_footprints(setup, frame);
    SensorScan scan;
    for (const ZoneFootprint& zone : footprints.zones) {
        scan.sensing.positions.push_back(zone.center_m.value_or(setup.wall.center_m));
        scan.sensing.normals.push_back(footprints.normal);
    }
    scan.illumination = scan.sensing;
    scan.opl_origin = OplOrigin::Device;
    scan.laser_position = footprints.laser_m;
    scan.detector_position = footprints.receiver_m;
    scan.setup = std::make_shared<const SensorSetup>(setup);
    return scan;
}

void observe_live_zones(const SensorSetup& setup, Capture& capture) {
    capture.observed = {};
    std::vector<bool> is_dead(static_cast<std::size_t>(setup.model.num_zones()), true);
    const std::size_t num_frames = capture.sequence ? capture.sequence->frames.size() : 1;
    for (std::size_t frame = 0; frame < (setup.poses.empty() ? 1 : num_frames); ++frame) {
        const SensorFootprints footprints = make_footprints(setup, frame);
        for (std::size_t zone = 0; zone < is_dead.size(); ++zone) {
            if (!footprints.zones[zone].is_dead()) is_dead[zone] = false;
        }
    }
    if (std::none_of(is_dead.begin(), is_dead.end(), [](bool dead) { return dead; })) return;
    std::vector<BinRange> ranges;
    for (const bool dead : is_dead) {
        ranges.push_back({0, dead ? 0 : capture.time_axis.num_bins});
    }
    restrict_observed(capture, ranges);
}

std::optional<SensorSetup> recorded_sensor(const Capture& capture) {
    if (const auto* scan = capture.scan.as<SensorScan>()) return *scan->setup;
    if (!capture.scene_info->is_object()) return std::nullopt;
    const auto found = capture.scene_info->find("sensor");
    if (found == capture.scene_info->end() || !found->is_object()) return std::nullopt;
    SensorSetup setup;
    read_value(*found, "scene_info.sensor", setup);
    validate(setup, "scene_info.sensor");
    return setup;
}

}  // namespace core
