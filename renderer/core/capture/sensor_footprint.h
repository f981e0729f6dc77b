// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/relay_wall.h"
#include "renderer/core/capture/sensor_model.h"
#include "renderer/core/types.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace core {

struct Capture;
struct SensorScan;

/// Where a sensor is and looks; its position is that of the receiving lens.
struct SensorPose {
    Vec3 position_m = Vec3::Zero();
    Vec3 forward = -Vec3::UnitZ();
    Vec3 up = Vec3::UnitY();

    /// Columns: to the right as the sensor sees it, up, and against the view.
    Mat3 world_from_sensor() const;
};

/// A sensor in front of a relay wall: all that says which points it lights and sees.
struct SensorSetup {
    SensorModel model;
    SensorPose pose;
    std::vector<SensorPose> poses;  ///< one per frame, in place of `pose`; empty: it stands still
    int subsamples = 3;             ///< per zone and axis
    RelayWall wall;

    const SensorPose& pose_of_frame(std::size_t frame) const {
        return poses.empty() ? pose : poses.at(frame);
    }
};

template <class Visitor>
void for_each_field(SensorPose& pose, Visitor&& visit) {
    visit("position_m", pose.position_m, "receiving lens, world [m]");
    visit("forward", pose.forward, "direction of view");
    visit("up", pose.up, "upwards, up to its part along the view");
}

template <class Visitor>
void for_each_field(SensorSetup& setup, Visitor&& visit) {
    visit("model", setup.model, "the sensor");
    visit("pose", setup.pose, "where it is and looks");
    visit("poses", setup.poses, "its poses frame by frame, in place of pose");
    visit("subsamples", setup.subsamples, Ranged{"points per zone and axis", {1, true, 64, true}});
    visit("wall", setup.wall, "the wall that it looks at");
}

/// Points of a patch of the wall, each for an equal part of a zone's image.
struct PatchPoints {
    std::vector<Vec3> positions;   ///< world [m]
    std::vector<double> weights;   ///< see ZoneFootprint
    std::vector<double> device_m;  ///< distance from laser or receiver [m]

    std::size_t size() const { return positions.size(); }
};

/// What a zone lights and sees of the wall. Rays that miss the wall leave no point.
struct ZoneFootprint {
    /// Weight: fraction of the laser's power, in proportion to the solid angle. All of the light
    /// adds up to 1 if it hits the wall: of all zones for flood light, of the zone where each
    /// lights its own spot.
    PatchPoints lit;

    /// Weight: solid angle times the cosine at the lens, relative to the mean zone's. Those of all
    /// zones add up to their number if every ray hits the wall.
    PatchPoints seen;

    /// Of the wall at the points of `seen`, per watt of laser power while the zone measures
    /// [1/m^2]: what the direct return and retroreflectors send back to the same point.
    std::vector<double> seen_irradiance;

    std::optional<Vec3> center_m;  ///< where the zone's middle looks, else the mean point seen

    /// Sees nothing of the wall, so that its histogram stays dark.
    bool is_dead() const { return seen.positions.empty(); }
};

/// The footprints of all zones in one frame.
struct SensorFootprints {
    Vec3 laser_m;                      ///< world
    Vec3 receiver_m;                   ///< world
    Vec3 normal;                       ///< of the wall, unit
    std::vector<ZoneFootprint> zones;  ///< as the model numbers them

    std::size_t num_dead() const;
};

/// Solid angle that a zone sees times the cosine at the lens, mean over the zones [sr].
double zone_etendue_sr(const SensorModel& model);

/// Throws Error naming the value that is out of range.
void validate(const SensorPose& pose, const std::string& where);
void validate(const SensorSetup& setup, const std::string& where);

/// Which points of the wall each zone lights and sees: subsamples x subsamples per zone, at the
/// centres of equal rectangles of the zone's image.
///
/// A zone's histogram per watt of laser power is then, with H(l, s) the radiance that leaves s for
/// 1 W on l,
///
///     H[zone] = sum over s in seen(zone), l in lit of weight(s) weight(l) H(l, s)
///
/// plus, with R(s) the radiance that leaves s for an irradiance of 1 W/m^2 that comes back to the
/// same point (its own return and retroreflectors),
///
///     sum over s in seen(zone) of weight(s) seen_irradiance(s) R(s)
///
/// with l in lit(zone) alone where zones light their own spots and in lit of all zones for flood
/// light; path lengths include the segments `device_m` of both.
///
/// setup    validated
/// throws   Error when no zone sees the wall
SensorFootprints make_footprints(const SensorSetup& setup, std::size_t frame = 0);

/// What it is and where it looks, for people: lines of text.
std::vector<std::string> describe_sensor(const SensorSetup& setup);

/// A confocal scan of the points that the middles of the zones look at, with the segments of laser
/// and receiver. Dead zones stand at the wall's centre.
///
/// throws   as make_footprints()
SensorScan scan_of_zones(const SensorSetup& setup, std::size_t frame = 0);

/// Marks in a capture of zones which of them see the wall in no frame: these are not observed.
///
/// setup    that the capture is of, with as many poses as the capture has frames or none
void observe_live_zones(const SensorSetup& setup, Capture& capture);

/// The set-up that a capture is of: its scan's, else what its provenance gives (scene_info, key
/// `sensor`), as `nlos render` writes it; nothing when it says nothing of the kind.
std::optional<SensorSetup> recorded_sensor(const Capture& capture);

}  // namespace core
