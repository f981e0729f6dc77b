// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace renderer {

/// Where a ray first meets the scene.
struct RayHit {
    std::uint32_t triangle = 0;
    double distance_m = 0.0;
};

/// Shadow segments that Embree tests together; lanes beyond `count` are ignored.
///
/// Single precision, relative to RayCaster::origin(); filled by RayCaster::aim.
struct alignas(64) SegmentPacket {
    static constexpr int kSize = 16;
    std::array<float, kSize> from_x, from_y, from_z;
    std::array<float, kSize> along_x, along_y, along_z;
    std::uint32_t blocked = 0;  ///< lane i as bit i
    int count = 0;
};

/// Directions (unit, world) that Embree traces together; lanes beyond `count` are ignored.
struct alignas(64) DirectionPacket {
    static constexpr int kSize = 16;
    static constexpr std::uint32_t kNone = ~0U;
    std::array<double, kSize> x, y, z;
    std::array<std::uint32_t, kSize> triangle;  ///< nearest one, or kNone
    std::array<double, kSize> distance_m;       ///< to it; undefined for kNone
    int count = 0;
};

/// Surface points by coordinate [m], SegmentPacket::kSize of them in each array.
struct SurfacePointLanes {
    const double *x, *y, *z;
    const double *normal_x, *normal_y, *normal_z;
};

/// Storage for them.
struct alignas(64) SegmentEnds {
    using Lanes = std::array<double, SegmentPacket::kSize>;
    Lanes x{}, y{}, z{};
    Lanes normal_x{}, normal_y{}, normal_z{};

    void set(std::size_t lane, const core::Vec3& position, const core::Vec3& normal) {
        x[lane] = position.x();
        y[lane] = position.y();
        z[lane] = position.z();
        normal_x[lane] = normal.x();
        normal_y[lane] = normal.y();
        normal_z[lane] = normal.z();
    }
    SurfacePointLanes lanes() const {
        return {x.data(), y.data(), z.data(), normal_x.data(), normal_y.data(), normal_z.data()};
    }
};

/// Distance by which the ends of segments leave surfaces within a box [m]: a bound of the rounding
/// of coordinates of that size to single precision.
double ray_offset_m(const Eigen::AlignedBox3d& box);

/// Ray queries against a fixed set of triangles (Embree, robust mode).
///
/// Embree works in single precision. Vertices are therefore stored relative to the centre of the
/// set, and segments between surface points are shortened by moving their ends off the surfaces by
/// offset_m(), see ray_offset_m(): small against 0.1 mm facets, and independent of how far the set
/// lies from the world's origin.
class RayCaster {
 public:
    /// corners   three world points per triangle [m]
    /// extra     points that rays will start from, so that rounding is bounded for them too
    RayCaster(std::span<const std::array<core::Vec3, 3>> corners,
              std::span<const core::Vec3> extra);
    ~RayCaster();
    RayCaster(RayCaster&&) noexcept;
    RayCaster& operator=(RayCaster&&) noexcept;

    /// Distance by which segment ends leave their surfaces [m].
    double offset_m() const { return offset_m_; }
    /// The centre of the box of the set and the extra points.
    const core::Vec3& origin() const { return origin_; }
    /// Half of the longest side of that box [m].
    double half_size_m() const { return half_size_m_; }

    /// Nearest triangle along a ray that starts on a surface with `normal` (unit, either side).
    std::optional<RayHit> first_hit(const core::Vec3& from,
                                    const core::Vec3& normal,
                                    const core::Vec3& direction) const;

    /// The same for several rays from one point: sets triangle and distance_m.
    void first_hits(const core::Vec3& from,
                    const core::Vec3& normal,
                    DirectionPacket& packet) const;

    /// True when something lies between two surface points with the given normals (unit).
    bool is_blocked(const core::Vec3& a,
                    const core::Vec3& normal_a,
                    const core::Vec3& b,
                    const core::Vec3& normal_b) const;

    /// Fills a packet with the segments from one surface point to the first `count` of several; the
    /// lanes beyond may hold anything.
    void aim(SegmentPacket& packet,
             const core::Vec3& from,
             const core::Vec3& normal,
             const SurfacePointLanes& to,
             int count) const;
    /// The same from a point of its own for each segment.
    void aim(SegmentPacket& packet,
             const SurfacePointLanes& from,
             const SurfacePointLanes& to,
             int count) const;

    /// Tests all segments of a packet: sets `blocked`, 0 beyond `count`.
    void trace(SegmentPacket& packet) const;

 private:
    template <class From>
    void aim_from(SegmentPacket& packet,
                  const From& from_of,
                  const SurfacePointLanes& to,
                  int count) const;
    double distance_to_plane(std::uint32_t triangle,
                             const core::Vec3& from,
                             const core::Vec3& direction) const;

    struct Embree;
    std::unique_ptr<Embree> embree_;
    core::Vec3 origin_ = core::Vec3::Zero();
    double half_size_m_ = 0.0;
    double offset_m_ = 0.0;
    std::vector<std::array<core::Vec3, 3>> corners_;  ///< for distances in double precision
};

}  // namespace renderer
