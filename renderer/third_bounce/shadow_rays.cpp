// SPDX-License-Identifier: MIT
#include "renderer/third_bounce/shadow_rays.h"

#include "renderer/core/random.h"
#include "renderer/core/stopwatch.h"

#include <bit>

namespace renderer {

using core::load;
using core::Simd;
using core::store;
using core::Vec3;

void ShadowRayTracer::look_from(const WallPointLanes& points) {
    from_all_.from.normal = points.normal;
    for (std::size_t p = 0; p < WallPointLanes::kSize; ++p) {
        from_all_.from.position.set(p, points.position[p] + set_.origin);
        point_bits_[p] =
            static_cast<std::uint32_t>(core::Rng(0, points.index[p], /*sample=*/0).next_bits());
    }
}

DrawnParts ShadowRayTracer::drawn_parts(std::uint32_t element) const {
    const ElementBlock& block = set_.blocks[element / ElementBlock::kSize];
    return {block.random_bits[element % ElementBlock::kSize], point_bits_};
}

std::uint32_t ShadowRayTracer::bit_of(const ShadowRays& rays,
                                      const DrawnParts& parts,
                                      std::size_t point) {
    return rays.part < ShadowRays::kFirstFixed ? parts.bit(point, parts.quarter(point, rays.part))
                                               : rays.part - ShadowRays::kFirstFixed;
}

void ShadowRayTracer::trace(std::span<ShadowRays> all) {
    const core::Stopwatch watch;
    constexpr PointMask kFull = 0xffff;
    for (ShadowRays& rays : all) {
        cost_.num_rays += static_cast<std::uint64_t>(std::popcount(rays.points));
        rays.seen = 0;
        if (rays.points == kFull) {
            trace_from_all(rays);
        } else {
            append(rays);
        }
    }
    trace_appended();
    cost_.seconds += watch.seconds();
}

void ShadowRayTracer::trace_from_all(ShadowRays& rays) {
    const ElementBlock& block = set_.blocks[rays.element / ElementBlock::kSize];
    const std::size_t i = rays.element % ElementBlock::kSize;
    const DrawnParts parts = drawn_parts(rays.element);
    Vec3Lanes<WallPointLanes::kSize> weights;
    for (std::size_t p = 0; p < WallPointLanes::kSize; ++p) {
        const auto& center = centers_of_bits()[bit_of(rays, parts, p)];
        weights.set(p, {center[0], center[1], center[2]});
    }
    const std::array corners{block.corners[0][i], block.corners[1][i], block.corners[2][i]};
    const Vec3 normal = block.normal[i];
    for (std::size_t begin = 0; begin < WallPointLanes::kSize; begin += Simd::size()) {
        const SimdVec3 b = weights.load(begin);
        const auto coordinate = [&](Eigen::Index k) {
            return b.x * corners[0][k] + b.y * corners[1][k] + b.z * corners[2][k];
        };
        from_all_.to.position.store({coordinate(0), coordinate(1), coordinate(2)}, begin);
        from_all_.to.normal.store({normal.x(), normal.y(), normal.z()}, begin);
        store(block.rise_m[i], from_all_.rise_m, begin);
    }
    rays.seen = static_cast<PointMask>(~blocked(from_all_, SegmentPacket::kSize));
}

void ShadowRayTracer::append(ShadowRays& rays) {
    const ElementBlock& block = set_.blocks[rays.element / ElementBlock::kSize];
    const std::size_t i = rays.element % ElementBlock::kSize;
    const DrawnParts parts = drawn_parts(rays.element);
    for_each_bit(rays.points, [&](std::size_t p) {
        const auto& b = centers_of_bits()[bit_of(rays, parts, p)];
        const std::size_t lane = num_pending_++;
        pending_[lane] = {&rays, p};
        appended_.from.position.set(lane, from_all_.from.position[p]);
        appended_.from.normal.set(lane, from_all_.from.normal[p]);
        appended_.to.position.set(
            lane,
            b[0] * block.corners[0][i] + b[1] * block.corners[1][i] + b[2] * block.corners[2][i]);
        appended_.to.normal.set(lane, block.normal[i]);
        appended_.rise_m[lane] = block.rise_m[i];
        if (num_pending_ == pending_.size()) trace_appended();
    });
}

void ShadowRayTracer::trace_appended() {
    if (num_pending_ == 0) return;
    const std::uint32_t all_blocked = blocked(appended_, static_cast<int>(num_pending_));
    for (std::size_t lane = 0; lane < num_pending_; ++lane) {
        const auto [rays, point] = pending_[lane];
        const std::uint32_t is_seen = ~all_blocked >> lane & 1U;
        rays->seen = static_cast<PointMask>(rays->seen | is_seen << point);
    }
    num_pending_ = 0;
}

// Which of the first `count` segments are blocked: lane i as bit i.
std::uint32_t ShadowRayTracer::blocked(Segments& segments, int count) {
    auto& [from, to, rise_m] = segments;
    for (std::size_t begin = 0; begin < rise_m.size(); begin += Simd::size()) {
        const SimdVec3 end = to.position.load(begin, -set_.origin);
        const SimdVec3 normal = to.normal.load(begin);
        const SimdVec3 start = from.position.load(begin);
        const SimdVec3 along{end.x - start.x, end.y - start.y, end.z - start.z};
        const Simd rise = load(rise_m, begin);
        const Simd moved = core::select(0.0 < along.dot(normal), -rise, rise);
        to.position.store(
            {end.x + moved * normal.x, end.y + moved * normal.y, end.z + moved * normal.z}, begin);
    }
    SegmentPacket packet;
    scene_.rays().aim(packet, from.lanes(), to.lanes(), count);
    scene_.rays().trace(packet);
    return packet.blocked;
}

}  // namespace renderer
