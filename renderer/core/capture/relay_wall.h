// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/settings.h"
#include "renderer/core/types.h"

#include <array>

namespace core {

/// The rectangle that laser and detector are aimed at.
struct RelayWall {
    Vec3 center_m = Vec3::Zero();
    Vec3 normal = Vec3::UnitZ();
    Vec3 up = Vec3::UnitY();
    std::array<double, 2> size_m{1.0, 1.0};
    double albedo = 1.0;

    /// x along up x normal, y up within the wall, z along the normal.
    Transform world_from_wall() const {
        const Vec3 z = normal.normalized();
        const Vec3 x = up.cross(z).normalized();
        Transform transform = Transform::Identity();
        transform.linear().col(0) = x;
        transform.linear().col(1) = z.cross(x);
        transform.linear().col(2) = z;
        transform.translation() = center_m;
        return transform;
    }
};

template <class Visitor>
void for_each_field(RelayWall& wall, Visitor&& visit) {
    visit("center_m", wall.center_m, "centre of the relay wall, world [m]");
    visit("normal", wall.normal, "towards the hidden side");
    visit("up", wall.up, "the wall's y axis, up to its part along the normal");
    visit("size_m", wall.size_m, above(0, "width and height [m]"));
    visit("albedo", wall.albedo, between(0, 1, "diffuse albedo of the wall"));
}

/// Throws Error naming the value that is out of range.
inline void validate(const RelayWall& wall, const std::string& where) {
    require(wall.normal.norm() > 1e-9, where + ".normal length", wall.normal.norm(), "above 0");
    require(wall.up.cross(wall.normal.normalized()).norm() > 1e-9 * (1.0 + wall.up.norm()),
            where + ".up part across the normal",
            0.0,
            "above 0");
    check_ranges(wall, where);
}

}  // namespace core
