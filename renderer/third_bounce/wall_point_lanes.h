// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/scene/ray_caster.h"
#include "renderer/third_bounce/vec3_lanes.h"

#include <cstdint>
#include <span>

namespace renderer {

/// A wall point; its position is relative to ElementSet::origin.
struct WallPoint {
    core::Vec3 position;
    core::Vec3 normal;
    std::uint32_t index = 0;  ///< among the points of its side
    bool is_confocal = true;  ///< some pair has both its ends here, see CoincidingPoints
};

inline bool coincide(const WallPoint& a, const WallPoint& b) {
    return a.position == b.position && a.normal == b.normal;
}

/// A set of wall points of a WallPointLanes: point p is bit p.
using PointMask = std::uint16_t;

/// Points of either mask.
inline PointMask combine(PointMask a, PointMask b) {
    return static_cast<PointMask>(a | b);
}
/// Points of the first mask that are not in the second one.
inline PointMask without(PointMask a, PointMask b) {
    return static_cast<PointMask>(a & ~b);
}
/// Points of both masks.
inline PointMask common(PointMask a, PointMask b) {
    return static_cast<PointMask>(a & b);
}

/// Wall points whose visibility is traced together, as many as a packet has rays: point p in lane p
/// of all arrays. Lanes beyond `count` repeat the first point.
struct alignas(64) WallPointLanes {
    static constexpr std::size_t kSize = SegmentPacket::kSize;
    using Lanes = std::array<double, kSize>;

    Vec3Lanes<kSize> position, normal;
    std::array<std::uint32_t, kSize> index;
    PointMask confocal = 0;  ///< those with WallPoint::is_confocal
    std::size_t count = 0;

    WallPointLanes() = default;
    /// points   1 to kSize of them
    explicit WallPointLanes(std::span<const WallPoint> points) : count(points.size()) {
        for (std::size_t p = 0; p < kSize; ++p) {
            const WallPoint& point = points[p < count ? p : 0];
            position.set(p, point.position);
            normal.set(p, point.normal);
            index[p] = point.index;
            confocal = static_cast<PointMask>(confocal | std::uint32_t{point.is_confocal} << p);
        }
    }
    PointMask all() const { return static_cast<PointMask>((std::uint32_t{1} << count) - 1U); }
};

}  // namespace renderer
