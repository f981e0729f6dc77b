// SPDX-License-Identifier: MIT
#include "renderer/core/capture/pinhole_camera.h"

#include <fmt/core.h>

#include <cmath>

namespace core {

Mat3 PinholeCamera::world_from_image() const {
    const Vec3 forward = (look_at_m - position_m).normalized();
    const Vec3 right = forward.cross(up).normalized();
    const Vec3 downwards = forward.cross(right);
    const double pixel_size = 2.0 * std::tan(0.5 * fov_y_deg * kPi / 180.0) / resolution[1];
    Mat3 map;
    map.col(0) = pixel_size * right;
    map.col(1) = pixel_size * downwards;
    map.col(2) = forward - 0.5 * resolution[0] * map.col(0) - 0.5 * resolution[1] * map.col(1);
    return map;
}

void validate(const PinholeCamera& camera, const std::string& where) {
    const auto text = [](const Vec3& v) {
        return fmt::format("({}, {}, {})", v.x(), v.y(), v.z());
    };
    const Vec3 view = camera.look_at_m - camera.position_m;
    require(view.norm() > 1e-9,
            where + ".look_at_m",
            text(camera.look_at_m) + ", the camera's own position",
            "another point");
    if (!(camera.up.cross(view.normalized()).norm() > 1e-9 * (1.0 + camera.up.norm()))) {
        throw Error(
            where + ".up", "found " + text(camera.up) + ", along the view", "must point across it");
    }
    check_ranges(camera, where);
    if (camera.light_m && camera.light_spot_m) {
        throw Error(where + ".light_spot_m",
                    "found together with light_m",
                    "must stand alone: there is one light");
    }
}

}  // namespace core
