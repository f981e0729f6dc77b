// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/settings.h"
#include "renderer/core/types.h"

#include <array>
#include <cstddef>
#include <optional>
#include <string>

namespace core {

/// A pinhole camera and the light of its scene.
///
/// Pixels are numbered x * height + y, y from the top, as captures store them. The light is an
/// isotropic point light of 1 W, by default at the camera, or a lit spot on a surface.
struct PinholeCamera {
    Vec3 position_m = Vec3::Zero();
    Vec3 look_at_m = Vec3::Zero();
    Vec3 up = Vec3::UnitY();
    double fov_y_deg = 45.0;                 ///< full vertical angle of view
    std::array<int, 2> resolution{128, 96};  ///< width and height in pixels
    std::optional<Vec3> light_m;             ///< point light; not together with light_spot_m
    std::optional<Vec3> light_spot_m;        ///< on a surface of the scene

    std::size_t width() const { return static_cast<std::size_t>(resolution[0]); }
    std::size_t height() const { return static_cast<std::size_t>(resolution[1]); }
    std::size_t num_pixels() const { return width() * height(); }

    Vec3 light_position() const {
        return light_spot_m ? *light_spot_m : light_m.value_or(position_m);
    }

    /// Maps (x, y, 1), a place in the image in pixels from its left and its upper edge, to a
    /// direction along which it is seen (not unit). Pixels are square.
    Mat3 world_from_image() const;
};

template <class Visitor>
void for_each_field(PinholeCamera& camera, Visitor&& visit) {
    visit("position_m", camera.position_m, "pinhole, world [m]");
    visit("look_at_m", camera.look_at_m, "what the middle of the image shows, world [m]");
    visit("up", camera.up, "upwards in the image, up to its part along the view");
    visit("fov_y_deg",
          camera.fov_y_deg,
          Ranged{"full vertical angle of view [degrees]", {.low = 0, .high = 180}});
    visit("resolution", camera.resolution, at_least(1, "width and height in pixels"));
    visit("light_m", camera.light_m, "isotropic 1 W light, world [m]; null: at the camera");
    visit("light_spot_m", camera.light_spot_m, "instead: lit spot on a surface, world [m]");
}

/// Throws Error naming the value that is out of range.
void validate(const PinholeCamera& camera, const std::string& where);

}  // namespace core
