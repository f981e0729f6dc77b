// SPDX-License-Identifier: MIT
#include "calib/track/track_sensor.h"

#include "renderer/core/principal_axes.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace calib {
namespace {

using core::Vec3;

constexpr double kFlatness = 0.1;  // of the points' extent
constexpr double kBeyondX_m = 1.0;
constexpr double kBeyondY_m = 0.75;
constexpr int kSpotPoints = 3;  // along each axis of a spot

// To the nearest other spot, or to the nearest one in another direction than `not_along`.
std::optional<Vec3> to_neighbour(const std::vector<Vec3>& spots,
                                 std::size_t spot,
                                 const std::optional<Vec3>& not_along) {
    constexpr double kSameDirection = 0.7;  // cosine
    std::optional<Vec3> nearest;
    for (std::size_t other = 0; other < spots.size(); ++other) {
        const Vec3 way = spots[other] - spots[spot];
        if (other == spot || way.norm() == 0.0) continue;
        if (not_along && std::abs(way.normalized().dot(not_along->normalized())) > kSameDirection) {
            continue;
        }
        if (!nearest || way.norm() < nearest->norm()) nearest = way;
    }
    return nearest;
}

}  // namespace

core::RelayWall wall_through(const std::vector<Vec3>& points_m, const std::string& where) {
    const core::PrincipalAxes principal = core::principal_axes(points_m);
    const Vec3& spread = principal.spread_m;
    if (points_m.size() < 3 || !(spread[1] > 1e-6 * spread[2])) {
        throw core::Error(where,
                          fmt::format("found {} wall points on a line", points_m.size()),
                          "must span a plane; state the wall by `wall`");
    }
    if (spread[0] > kFlatness * spread[2]) {
        throw core::Error(where,
                          fmt::format("wall points lie {:.2g} of their extent off a plane",
                                      spread[0] / spread[2]),
                          "must lie in one plane; state the wall by `wall`");
    }
    core::RelayWall wall;
    wall.normal = principal.axes.col(0);
    const double towards =
        std::abs(wall.normal.z()) > 0.1 ? wall.normal.z() : -wall.normal.dot(principal.center_m);
    if (towards < 0.0) wall.normal = -wall.normal;
    if (std::abs(wall.normal.dot(wall.up)) > 0.9) wall.up = Vec3::UnitX();
    // The point nearest to the origin, so that x and y of a wall along z = c are those of the
    // world.
    wall.center_m = wall.normal.dot(principal.center_m) * wall.normal;
    const core::Transform wall_from_world = wall.world_from_wall().inverse();
    Vec3 reach = Vec3::Zero();
    for (const Vec3& p : points_m) reach = reach.cwiseMax((wall_from_world * p).cwiseAbs());
    wall.size_m = {2.0 * reach.x() + 1.0, 2.0 * reach.y() + 1.0};
    return wall;
}

core::SensorFootprints footprints_of_spots(const std::vector<Vec3>& spots_m,
                                           const core::RelayWall& wall,
                                           const Vec3& device_m) {
    const core::Transform world_from_wall = wall.world_from_wall();
    std::vector<Vec3> spots;
    for (const Vec3& p : spots_m) {
        Vec3 flat = world_from_wall.inverse() * p;
        flat.z() = 0.0;
        spots.push_back(flat);
    }
    core::SensorFootprints footprints;
    footprints.normal = wall.normal.normalized();
    footprints.laser_m = footprints.receiver_m = device_m;
    for (std::size_t s = 0; s < spots.size(); ++s) {
        const Vec3 u = to_neighbour(spots, s, std::nullopt).value_or(Vec3::Zero());
        const Vec3 v = spots.size() > 1 ? to_neighbour(spots, s, u).value_or(Vec3::Zero())
                                        : Vec3(Vec3::Zero());
        const double area_m2 = u.cross(v).norm();
        core::ZoneFootprint zone;
        zone.center_m = world_from_wall * spots[s];
        constexpr double kFraction = 1.0 / (kSpotPoints * kSpotPoints);
        for (int i = 0; i < kSpotPoints; ++i) {
            for (int j = 0; j < kSpotPoints; ++j) {
                const double a = (i + 0.5) / kSpotPoints - 0.5;
                const double b = (j + 0.5) / kSpotPoints - 0.5;
                const Vec3 p = world_from_wall * Vec3(spots[s] + a * u + b * v);
                for (core::PatchPoints* points : {&zone.lit, &zone.seen}) {
                    points->positions.push_back(p);
                    points->weights.push_back(kFraction);
                    points->device_m.push_back((p - device_m).norm());
                }
                zone.seen_irradiance.push_back(area_m2 > 0.0 ? 1.0 / area_m2 : 1.0);
            }
        }
        footprints.zones.push_back(std::move(zone));
    }
    return footprints;
}

core::SensorFootprints footprints_at(const TrackSensor& sensor, const core::SensorPose& pose) {
    if (!sensor.setup) return footprints_of_spots(sensor.spots_m, sensor.wall, sensor.device_m);
    core::SensorSetup setup = *sensor.setup;
    setup.pose = pose;
    setup.poses.clear();
    return core::make_footprints(setup);
}

TargetResponse response_at(const TrackSensor& sensor,
                           const core::SensorFootprints& footprints,
                           const TargetSettings& target) {
    auto illumination = core::SensorIllumination::Zones;
    ZoneCrosstalk crosstalk;
    if (sensor.setup) {
        const core::SensorModel& model = sensor.setup->model;
        illumination = model.illumination;
        crosstalk = {model.zones[0], model.zones[1], model.detector.zone_crosstalk};
    }
    return {footprints,
            sensor.axis,
            target,
            illumination,
            sensor.opl_origin,
            sensor.sigma_m,
            crosstalk};
}

SearchBox search_box(const TrackSettings& settings,
                     const core::RelayWall& wall,
                     const core::SensorFootprints& footprints) {
    SearchBox box;
    box.world_from_wall = wall.world_from_wall();
    Eigen::AlignedBox3d seen;
    for (const core::ZoneFootprint& zone : footprints.zones) {
        for (const Vec3& p : zone.seen.positions) seen.extend(box.world_from_wall.inverse() * p);
    }
    box.ranges_m[0] = settings.search.x_range_m.value_or(
        std::array{seen.min().x() - kBeyondX_m, seen.max().x() + kBeyondX_m});
    box.ranges_m[1] = settings.search.y_range_m.value_or(
        std::array{seen.min().y() - kBeyondY_m, seen.max().y() + kBeyondY_m});
    box.ranges_m[2] = settings.search.z_range_m;
    return box;
}

}  // namespace calib
