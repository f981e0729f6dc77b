// SPDX-License-Identifier: MIT
#include "renderer/third_bounce/shadow_rays.h"

#include "renderer/core/random.h"
#include "renderer/core/stopwatch.h"
#include "renderer/third_bounce/simd_groups.h"

#include <bit>

namespace renderer {

using core::load;
using core::Simd;
using core::store;
using core::Vec3;

ShadowRayTracer::ShadowRayTracer(const Scene& scene, const ElementSet& elements)
    : scene_(scene), set_(elements) {}

void ShadowRayTracer::look_from(const WallPointLanes& points) {
    for (std::size_t p = 0; p < WallPointLanes::kSize; ++p) {
        from_all_.from.set(p,
                           points.position(p) + set_.origin,
                           {points.normal_x[p], points.normal_y[p], points.normal_z[p]});
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
        num_rays_ += static_cast<std::uint64_t>(std::popcount(rays.points));
        rays.seen = 0;
        if (rays.points == kFull) {
            trace_from_all(rays);
        } else {
            append(rays);
        }
    }
    trace_appended();
    seconds_ += watch.seconds();
}

void ShadowRayTracer::trace_from_all(ShadowRays& rays) {
    const ElementBlock& block = set_.blocks[rays.element / ElementBlock::kSize];
    const std::size_t i = rays.element % ElementBlock::kSize;
    const DrawnParts parts = drawn_parts(rays.element);
    std::array<std::uint32_t, WallPointLanes::kSize> bits;
    for (std::size_t p = 0; p < bits.size(); ++p) bits[p] = bit_of(rays, parts, p);
    alignas(64) std::array<SegmentEnds::Lanes, 3> weights;
    const auto& centers = centers_of_bits();
    for (std::size_t p = 0; p < bits.size(); ++p) {
        const auto& center = centers[bits[p]];
        for (std::size_t c = 0; c < 3; ++c) weights[c][p] = center[c];
    }
    SegmentEnds& to = from_all_.to;
    for (std::size_t begin = 0; begin < WallPointLanes::kSize; begin += Simd::size()) {
        const auto interpolate = [&](const std::array<ElementBlock::Lanes, 3>& corners) {
            return load(weights[0], begin) * corners[0][i] +
                   load(weights[1], begin) * corners[1][i] +
                   load(weights[2], begin) * corners[2][i];
        };
        store(interpolate(block.x), to.x, begin);
        store(interpolate(block.y), to.y, begin);
        store(interpolate(block.z), to.z, begin);
        store(block.normal_x[i], to.normal_x, begin);
        store(block.normal_y[i], to.normal_y, begin);
        store(block.normal_z[i], to.normal_z, begin);
        store(block.rise_m[i], from_all_.rise_m, begin);
    }
    rays.seen = static_cast<PointMask>(~blocked(from_all_, SegmentPacket::kSize));
}

void ShadowRayTracer::append(ShadowRays& rays) {
    const ElementBlock& block = set_.blocks[rays.element / ElementBlock::kSize];
    const std::size_t i = rays.element % ElementBlock::kSize;
    const DrawnParts parts = drawn_parts(rays.element);
    const SegmentEnds& points = from_all_.from;
    const auto& centers = centers_of_bits();
    for_each_bit(rays.points, [&](std::size_t p) {
        const auto& b = centers[bit_of(rays, parts, p)];
        const auto interpolate = [&](const std::array<ElementBlock::Lanes, 3>& corners) {
            return b[0] * corners[0][i] + b[1] * corners[1][i] + b[2] * corners[2][i];
        };
        const std::size_t lane = num_pending_++;
        pending_[lane] = {&rays, p};
        appended_.from.set(lane,
                           {points.x[p], points.y[p], points.z[p]},
                           {points.normal_x[p], points.normal_y[p], points.normal_z[p]});
        appended_.to.set(lane,
                         {interpolate(block.x), interpolate(block.y), interpolate(block.z)},
                         {block.normal_x[i], block.normal_y[i], block.normal_z[i]});
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

// Lanes of the first `count` segments that something lies in.
std::uint32_t ShadowRayTracer::blocked(Segments& segments, int count) {
    auto& [from, to, rise_m] = segments;
    for (std::size_t begin = 0; begin < rise_m.size(); begin += Simd::size()) {
        const SimdGroupPoints end = load_points(to.x, to.y, to.z, begin, -set_.origin);
        const SimdGroupPoints normal =
            load_points(to.normal_x, to.normal_y, to.normal_z, begin, Vec3::Zero());
        const SimdGroupPoints along{
            end.x - load(from.x, begin), end.y - load(from.y, begin), end.z - load(from.z, begin)};
        const Simd rise = load(rise_m, begin);
        const Simd moved = core::select(0.0 < along.dot(normal), -rise, rise);
        store(end.x + moved * normal.x, to.x, begin);
        store(end.y + moved * normal.y, to.y, begin);
        store(end.z + moved * normal.z, to.z, begin);
    }
    SegmentPacket packet;
    scene_.rays().aim(packet, from.lanes(), to.lanes(), count);
    scene_.rays().trace(packet);
    return packet.blocked;
}

}  // namespace renderer
