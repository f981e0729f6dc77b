// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/geometry/visibility_mask.h"
#include "renderer/third_bounce/surface_subdivider.h"
#include "renderer/third_bounce/wall_point_lanes.h"

#include <array>
#include <cstdint>
#include <span>

namespace renderer {

/// The parts of an element that its first rays go to, one in each quarter, drawn at random for each
/// wall point. Fixed parts would miss shadows that cover less than half of many elements, such as
/// those of bumps. All parts are equally likely, so that shadows count by the area they cover.
class DrawnParts {
 public:
    /// Random bits of an element and of wall points.
    using PointBits = std::array<std::uint32_t, WallPointLanes::kSize>;
    DrawnParts(std::uint32_t element_bits, const PointBits& point_bits)
        : element_bits_(element_bits), point_bits_(&point_bits) {}

    /// The quarter that comes k-th, 0 to 3.
    std::uint32_t quarter(std::size_t point, std::uint32_t k) const {
        return (draw(point) + k) & 3U;
    }
    /// The bit of VisibilityMask drawn from a quarter.
    std::uint32_t bit(std::size_t point, std::uint32_t quarter) const {
        return 4 * quarter + (draw(point) >> (2 * quarter + 2) & 3U);
    }

 private:
    // The finalizer of MurmurHash3 (source [Appleby2011]): any change flips about half of the bits.
    std::uint32_t draw(std::size_t point) const {
        std::uint32_t bits = element_bits_ ^ (*point_bits_)[point];
        bits = (bits ^ (bits >> 16)) * 0x85ebca6bU;
        bits = (bits ^ (bits >> 13)) * 0xc2b2ae35U;
        return bits ^ (bits >> 16);
    }

    std::uint32_t element_bits_;
    const PointBits* point_bits_;
};

/// Rays from some wall points to one part of an element each.
struct ShadowRays {
    std::uint32_t element = 0;
    PointMask points = 0;
    std::uint8_t part = 0;  ///< drawn() or fixed()
    PointMask seen = 0;     ///< of `points`, those with an unoccluded ray; set by tracing

    /// `part` of the part drawn from the quarter that comes k-th.
    static constexpr std::uint8_t drawn(std::uint32_t k) { return static_cast<std::uint8_t>(k); }
    /// `part` of the same one for all points.
    static constexpr std::uint8_t fixed(std::uint32_t bit) {
        return static_cast<std::uint8_t>(kFirstFixed + bit);
    }
    static constexpr std::uint8_t kFirstFixed = 4;
};

/// What tracing shadow rays takes.
struct TracingCost {
    std::uint64_t num_rays = 0;
    double seconds = 0.0;  ///< aiming rays, tracing them and reading the answers, of all threads

    TracingCost& operator+=(const TracingCost& other) {
        num_rays += other.num_rays;
        seconds += other.seconds;
        return *this;
    }
};

/// Traces shadow rays from up to WallPointLanes::kSize wall points in packets. Rays from
/// neighbouring wall points to one element are coherent and load its corners only once.
class ShadowRayTracer {
 public:
    /// scene, elements   must outlive the tracer
    ShadowRayTracer(const Scene& scene, const ElementSet& elements)
        : scene_(scene), set_(elements) {}

    /// Sets the points at which rays begin.
    void look_from(const WallPointLanes& points);

    DrawnParts drawn_parts(std::uint32_t element) const;

    /// Sets `seen` of all.
    void trace(std::span<ShadowRays> rays);

    const TracingCost& cost() const { return cost_; }

 private:
    struct Pending {
        ShadowRays* rays;
        std::size_t point;
    };
    /// Ends of segments on surfaces.
    struct Ends {
        Vec3Lanes<SegmentPacket::kSize> position{}, normal{};

        SurfacePointLanes lanes() const {
            const auto& [x, y, z] = position;
            return {
                x.data(), y.data(), z.data(), normal.x.data(), normal.y.data(), normal.z.data()};
        }
    };
    /// Segments before they are aimed.
    struct Segments {
        Ends from;                                   ///< world
        Ends to;                                     ///< relative to ElementSet::origin
        alignas(64) WallPointLanes::Lanes rise_m{};  ///< what `to` is moved by towards `from`
    };
    static std::uint32_t bit_of(const ShadowRays& rays, const DrawnParts& parts, std::size_t point);
    void trace_from_all(ShadowRays& rays);
    void append(ShadowRays& rays);
    void trace_appended();
    std::uint32_t blocked(Segments& segments, int count);

    const Scene& scene_;
    const ElementSet& set_;
    DrawnParts::PointBits point_bits_{};
    Segments from_all_;                                  ///< from all points to one element
    Segments appended_;                                  ///< any others
    std::array<Pending, SegmentPacket::kSize> pending_;  ///< the rays of appended_
    std::size_t num_pending_ = 0;
    TracingCost cost_;
};

}  // namespace renderer
