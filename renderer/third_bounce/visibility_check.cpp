// SPDX-License-Identifier: MIT
#include "renderer/third_bounce/visibility_check.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

using core::load;
using core::Simd;
using core::Vec3;

// (n_w.d) (n_x.d) / |d|^4 of one segment, 0 behind the wall point; the sign is that of n_x.d.
[[gnu::always_inline]] inline Simd segment_terms(const ElementBlock& block,
                                                 std::size_t begin,
                                                 const WallPoint& point) {
    const SimdVec3 d = block.center.load(begin, point.position);
    const Simd d2 = d.dot(d);
    const SimdVec3 normal = block.normal.load(begin);
    return core::max(d.dot(point.normal), 0.0) * d.dot(normal) / (d2 * d2);
}

double segment_term(const WallPoint& from, const Vec3& position, const Vec3& normal) {
    const Vec3 d = position - from.position;
    return std::max(0.0, d.dot(from.normal)) * d.dot(normal) / std::pow(d.squaredNorm(), 2);
}

// The mask of an element, 0 where none was written.
VisibilityMask mask_of(const VisibleElements& seen, std::uint32_t element) {
    const std::size_t block = element / ElementBlock::kSize;
    const std::size_t simd_group = element % ElementBlock::kSize / ElementBlock::kSimdWidth;
    return (seen.simd_groups[block] >> simd_group & 1U) != 0 ? seen.masks[element]
                                                             : VisibilityMask{0};
}

}  // namespace

SquaredError squared_error_of(const VisibilityDifferences& differences) {
    SquaredError sum;
    for (std::size_t bin = 0; bin < differences[0].size(); ++bin) {
        const double product = differences[0][bin] * differences[1][bin];
        sum += {product, product * product};
    }
    return sum;
}

void VisibilityCheck::add_differences(const End& light,
                                      const End& sensor,
                                      const core::TimeAxis& axis,
                                      std::size_t num_rays,
                                      core::Rng rng,
                                      VisibilityDifferences& sums) {
    sum_masses(light.point, sensor.point);
    if (mass_up_to_.empty() || !(mass_up_to_.back() > 0.0)) return;
    for (std::vector<double>& set : sums) {
        draw_targets(num_rays, rng);
        is_blocked_.assign(num_rays, false);
        trace_from(light.point);
        if (!coincide(light.point, sensor.point)) trace_from(sensor.point);
        add(light, sensor, axis, set);
    }
}

void VisibilityCheck::sum_masses(const WallPoint& light, const WallPoint& sensor) {
    const bool is_confocal = coincide(light, sensor);
    mass_up_to_.resize(set_.blocks.size() * ElementBlock::kSize);
    double sum = 0.0;
    for (std::size_t b = 0; b < set_.blocks.size(); ++b) {
        const ElementBlock& block = set_.blocks[b];
        const bool looks_back = block.response.towards_source;
        for (std::size_t begin = 0; begin < ElementBlock::kSize; begin += Simd::size()) {
            const Simd first = segment_terms(block, begin, light);
            const Simd second = is_confocal ? first : segment_terms(block, begin, sensor);
            // Both ends on the same side of the element, and that a reflecting one.
            const core::SimdMask reflects = 0.0 <= -load(block.one_sided, begin) * first;
            Simd mass = looks_back ? core::max(first, -first) : core::max(first * second, 0.0);
            if (looks_back && !is_confocal) mass = 0.0;
            mass *= load(block.area_m2, begin) * load(block.mean_reflectance, begin);
            mass = core::select(reflects, mass, 0.0);
            for (std::size_t i = 0; i < Simd::size(); ++i) {
                sum += mass[i];
                mass_up_to_[b * ElementBlock::kSize + begin + i] = sum;
            }
        }
    }
}

// One for each of equal fractions of the mass.
void VisibilityCheck::draw_targets(std::size_t count, core::Rng& rng) {
    targets_.clear();
    auto found = mass_up_to_.begin();
    for (std::size_t i = 0; i < count; ++i) {
        const double mass = (static_cast<double>(i) + rng.uniform()) / static_cast<double>(count) *
                            mass_up_to_.back();
        found = std::find_if(found, mass_up_to_.end(), [&](double up_to) { return mass < up_to; });
        if (found == mass_up_to_.end()) break;  // by rounding
        const auto element = static_cast<std::uint32_t>(found - mass_up_to_.begin());
        const double root = std::sqrt(rng.uniform());
        const double last = root * rng.uniform();
        const std::array<double, 3> fraction{1.0 - root, root - last, last};
        const ElementBlock& block = set_.blocks[element / ElementBlock::kSize];
        Vec3 position = Vec3::Zero();
        for (std::size_t c = 0; c < 3; ++c) {
            position += fraction[c] * block.corners[c][element % ElementBlock::kSize];
        }
        targets_.push_back({element, fraction, position});
    }
}

void VisibilityCheck::trace_from(const WallPoint& point) {
    SegmentEnds ends;
    SegmentPacket packet;
    for (std::size_t begin = 0; begin < targets_.size(); begin += SegmentPacket::kSize) {
        const std::size_t count =
            std::min<std::size_t>(SegmentPacket::kSize, targets_.size() - begin);
        for (std::size_t i = 0; i < count; ++i) {
            const auto& [element, fraction, position] = targets_[begin + i];
            const ElementBlock& block = set_.blocks[element / ElementBlock::kSize];
            const Vec3 normal = block.normal[element % ElementBlock::kSize];
            const double rise = std::copysign(block.rise_m[element % ElementBlock::kSize],
                                              normal.dot(point.position - position));
            ends.set(i, position + rise * normal + set_.origin, normal);
        }
        scene_.rays().aim(packet,
                          point.position + set_.origin,
                          point.normal,
                          ends.lanes(),
                          static_cast<int>(count));
        scene_.rays().trace(packet);
        for_each_bit(packet.blocked, [&](std::size_t i) { is_blocked_[begin + i] = true; });
    }
    num_rays_ += targets_.size();
}

// What a unit of area at the target adds to H if it is visible.
double VisibilityCheck::weight_of(const Target& target,
                                  const WallPoint& light,
                                  const WallPoint& sensor) const {
    const ElementBlock& block = set_.blocks[target.element / ElementBlock::kSize];
    const std::size_t lane = target.element % ElementBlock::kSize;
    const Vec3 normal = block.normal[lane];
    const double first = segment_term(light, target.position, normal);
    if (block.response.towards_source) {
        return block.mean_reflectance[lane] * std::abs(first);
    }
    const double both = std::max(0.0, first * segment_term(sensor, target.position, normal));
    if (!block.response.glossy) return block.mean_reflectance[lane] * both;
    const core::Mat3 local_from_world =
        core::frame_from_normal(normal, block.corners[1][lane] - block.corners[0][lane])
            .transpose();
    const auto direction_to = [&](const WallPoint& point) -> Vec3 {
        return local_from_world * (point.position - target.position).normalized();
    };
    const Bsdf bsdf = scene_.bsdf_at({target.position + set_.origin, block.facet[lane]});
    return evaluate_bsdf(bsdf, direction_to(light), direction_to(sensor)) * both;
}

// Per bin, the weight that the masks leave out, or below 0 what they add.
void VisibilityCheck::add(const End& light,
                          const End& sensor,
                          const core::TimeAxis& axis,
                          std::vector<double>& sums) const {
    sums.resize(static_cast<std::size_t>(axis.num_bins));
    const double mass_per_ray = mass_up_to_.back() / static_cast<double>(targets_.size());
    for (std::size_t i = 0; i < targets_.size(); ++i) {
        const Target& target = targets_[i];
        const std::uint32_t element = target.element;
        const auto mask = static_cast<VisibilityMask>(mask_of(light.seen, element) &
                                                      mask_of(sensor.seen, element));
        if (mask == (is_blocked_[i] ? 0 : kAllVisible)) continue;
        const std::array<double, 3> fraction = visible_fraction(mask);
        double difference = is_blocked_[i] ? 0.0 : 1.0;
        for (std::size_t c = 0; c < 3; ++c) difference -= target.fraction[c] * fraction[c];
        const double opl = (target.position - light.point.position).norm() +
                           (target.position - sensor.point.position).norm();
        const std::optional<int> bin = axis.bin_of(opl);
        if (!bin) continue;
        const ElementBlock& block = set_.blocks[element / ElementBlock::kSize];
        const std::size_t lane = element % ElementBlock::kSize;
        const double mass = mass_up_to_[element] - (element > 0 ? mass_up_to_[element - 1] : 0.0);
        const double per_target = mass_per_ray * block.area_m2[lane] / mass;
        sums[static_cast<std::size_t>(*bin)] +=
            per_target * weight_of(target, light.point, sensor.point) * difference;
    }
}

}  // namespace renderer
