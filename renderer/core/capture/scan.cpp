// SPDX-License-Identifier: MIT
#include "renderer/core/capture/scan.h"

#include "renderer/core/capture/sensor_footprint.h"

namespace core {
namespace {

template <class AnyWallScan>
AnyWallScan moved_points(AnyWallScan scan, const Vec3& way) {
    for (WallPoints* points : {&scan.illumination, &scan.sensing}) {
        for (Vec3& position : points->positions) position += way;
    }
    scan.laser_position += way;
    scan.detector_position += way;
    return scan;
}

Scan moved_zones(const SensorScan& scan, const Vec3& way) {
    SensorScan result = moved_points(scan, way);
    SensorSetup setup = *scan.setup;
    setup.wall.center_m += way;
    setup.pose.position_m += way;
    for (SensorPose& pose : setup.poses) pose.position_m += way;
    result.setup = std::make_shared<const SensorSetup>(std::move(setup));
    return result;
}

Scan moved_image(ImageScan image, const Vec3& way) {
    PinholeCamera& camera = image.camera;
    camera.position_m += way;
    camera.look_at_m += way;
    if (camera.light_m) *camera.light_m += way;
    if (camera.light_spot_m) *camera.light_spot_m += way;
    return image;
}

}  // namespace

const WallScan& Scan::wall(const std::string& where) const {
    if (const auto* scan = as<WallScan>()) return *scan;
    throw Error(where, "found the image of a camera", "must be a scan of points on a relay wall");
}

Scan moved(const Scan& scan, const Vec3& way) {
    return scan.visit([&](const WallScan& wall) -> Scan { return moved_points(wall, way); },
                      [&](const SensorScan& zones) { return moved_zones(zones, way); },
                      [&](const ImageScan& image) { return moved_image(image, way); });
}

void validate(const Scan& scan, const std::string& where) {
    scan.visit([&](const auto& kind) { validate(kind, where); });
}

}  // namespace core
