// SPDX-License-Identifier: MIT
#include "nlos/solver/pair_operator.h"

#include "renderer/core/system/parallel.h"

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

constexpr std::size_t kVoxelsPerChunk = 512;

std::vector<Eigen::Vector3f> to_wall_frame(const core::Transform& world_from_wall,
                                           const core::WallPoints& points) {
    const core::Transform wall_from_world = world_from_wall.inverse(Eigen::Isometry);
    std::vector<Eigen::Vector3f> result;
    for (const core::Vec3& position : points.positions) {
        result.push_back((wall_from_world * position).cast<float>());
    }
    return result;
}

}  // namespace

/// Where a chunk of voxels adds to one histogram, and how much.
struct PairOperator::Segments {
    std::vector<float> positions = std::vector<float>(kVoxelsPerChunk);  ///< 1: centre of bin 0
    std::vector<float> slopes = std::vector<float>(kVoxelsPerChunk);     ///< for spots
    std::vector<float> factors = std::vector<float>(kVoxelsPerChunk);
    // Of one point of the spot:
    std::vector<int> bins = std::vector<int>(kVoxelsPerChunk);  ///< 0: before bin 0
    std::vector<float> late = std::vector<float>(kVoxelsPerChunk);
};

PairOperator::PairOperator(const MethodInput& input, Falloff falloff, double spot_m)
    : scan_(input.scan),
      axis_(input.time_axis),
      num_bins_(static_cast<std::size_t>(input.time_axis.num_bins)),
      response_(input.measurement.response),
      falloff_(falloff),
      spot_{{0.0F, 1.0F}},
      gains_(input.scan.num_pairs()),
      illumination_(to_wall_frame(input.axes.world_from_wall, input.scan.illumination)),
      sensing_(to_wall_frame(input.axes.world_from_wall, input.scan.sensing)) {
    if (spot_m > 0.0) {  // three points of Gauss and Hermite
        const double deviation = spot_m / std::sqrt(8.0 * std::log(2.0)) / axis_.bin_width_m;
        const auto shift = static_cast<float>(std::sqrt(3.0) * deviation);
        spot_ = {{-shift, 1.0F / 6.0F}, {0.0F, 2.0F / 3.0F}, {shift, 1.0F / 6.0F}};
    }
    for (std::size_t pair = 0; pair < scan_.num_pairs(); ++pair) {
        observed_.push_back(input.observed ? (*input.observed)[pair]
                                           : core::BinRange{0, axis_.num_bins});
        device_segments_bins_.push_back(
            static_cast<float>(scan_.device_segments_m(pair) / axis_.bin_width_m));
    }
}

void PairOperator::set_voxels(std::vector<Eigen::Vector3f> positions) {
    x_.clear();
    y_.clear();
    z_.clear();
    for (const Eigen::Vector3f& position : positions) {
        x_.push_back(position.x());
        y_.push_back(position.y());
        z_.push_back(position.z());
    }
}

// Divisions and square roots take most of the time of forward() and adjoint(): as few as possible.
void PairOperator::fill_segments(std::size_t pair,
                                 std::size_t begin,
                                 std::size_t end,
                                 Segments& segments) const {
    const Eigen::Vector3f l = illumination_[scan_.illumination_index(pair)];
    const Eigen::Vector3f s = sensing_[scan_.sensing_index(pair)];
    const auto per_bin = static_cast<float>(1.0 / axis_.bin_width_m);
    // Half a bin behind the axis's start.
    const float offset = device_segments_bins_[pair] + 0.5F -
                         static_cast<float>(axis_.opl_start_m / axis_.bin_width_m);
    const float gain = gains_[pair];
    const float* __restrict x = x_.data() + begin;
    const float* __restrict y = y_.data() + begin;
    const float* __restrict z = z_.data() + begin;
    float* __restrict positions = segments.positions.data();
    float* __restrict factors = segments.factors.data();
    // product: of both segments; inverse: of its square; heights: product of the heights
    const auto fill = [&](const auto& factor_of) {
        for (std::size_t i = 0; i < end - begin; ++i) {
            const float lx = x[i] - l.x(), ly = y[i] - l.y(), lz = z[i] - l.z();
            const float sx = x[i] - s.x(), sy = y[i] - s.y(), sz = z[i] - s.z();
            const float out2 = lx * lx + ly * ly + lz * lz;
            const float back2 = sx * sx + sy * sy + sz * sz;
            const float out = std::sqrt(out2), back = std::sqrt(back2);
            positions[i] = (out + back) * per_bin + offset;
            factors[i] = gain * factor_of(out * back, 1.0F / (out2 * back2), lz * sz);
        }
    };
    if (falloff_ == Falloff::Retro) {
        fill([](float product, float inverse, float) { return product * inverse; });
    } else if (falloff_ == Falloff::Facing) {
        fill([](float, float inverse, float heights) {
            return heights * inverse * (heights * inverse);
        });
    } else {
        fill([](float, float inverse, float) { return inverse; });
    }
    if (spot_.size() == 1) return;
    const float joint = scan_.pattern == core::ScanPattern::Confocal ? 2.0F : 0.0F;
    float* __restrict slopes = segments.slopes.data();
    for (std::size_t i = 0; i < end - begin; ++i) {
        const float lx = x[i] - l.x(), ly = y[i] - l.y(), lz = z[i] - l.z();
        const float sx = x[i] - s.x(), sy = y[i] - s.y(), sz = z[i] - s.z();
        const float out2 = lx * lx + ly * ly + lz * lz;
        const float back2 = sx * sx + sy * sy + sz * sz;
        slopes[i] = std::sqrt((lx * lx + ly * ly) / out2 + (sx * sx + sy * sy) / back2 +
                              joint * (lx * sx + ly * sy) / std::sqrt(out2 * back2));
    }
}

void PairOperator::place(const SpotPoint& point, std::size_t count, Segments& segments) const {
    const auto last = static_cast<float>(num_bins_ + 1);
    const float* __restrict positions = segments.positions.data();
    const float* __restrict slopes = segments.slopes.data();
    int* __restrict bins = segments.bins.data();
    float* __restrict late = segments.late.data();
    for (std::size_t i = 0; i < count; ++i) {
        float position = positions[i] + point.shift_bins * slopes[i];
        position = position > 0.0F ? position : 0.0F;
        position = position < last ? position : last;
        bins[i] = static_cast<int>(position);
        late[i] = position - static_cast<float>(bins[i]);
    }
}

void PairOperator::blur(std::span<const float> input,
                        std::span<float> output,
                        bool is_adjoint) const {
    if (response_.weights.empty()) {
        std::ranges::copy(input, output.begin());
        return;
    }
    const auto bins = static_cast<std::ptrdiff_t>(input.size());
    std::ranges::fill(output, 0.0F);
    for (std::size_t k = 0; k < response_.weights.size(); ++k) {
        const auto delay = response_.first_delay + static_cast<std::ptrdiff_t>(k);
        const auto weight = static_cast<float>(response_.weights[k]);
        for (std::ptrdiff_t from = std::max<std::ptrdiff_t>(0, -delay);
             from < std::min(bins, bins - delay);
             ++from) {
            const auto early = static_cast<std::size_t>(from);
            const auto delayed = static_cast<std::size_t>(from + delay);
            if (is_adjoint) {
                output[early] += weight * input[delayed];
            } else {
                output[delayed] += weight * input[early];
            }
        }
    }
}

void PairOperator::forward(std::span<const float> albedo,
                           std::span<const std::size_t> pairs,
                           std::span<float> histograms) const {
    core::parallel_blocks(pairs.size(), 4, [&](std::size_t begin, std::size_t end) {
        Segments segments;
        std::vector<float> padded(num_bins_ + 3);
        for (std::size_t i = begin; i < end; ++i) {
            std::ranges::fill(padded, 0.0F);
            for (std::size_t first = 0; first < num_voxels(); first += kVoxelsPerChunk) {
                const std::size_t count = std::min(kVoxelsPerChunk, num_voxels() - first);
                fill_segments(pairs[i], first, first + count, segments);
                for (const SpotPoint& point : spot_) {
                    place(point, count, segments);
                    for (std::size_t v = 0; v < count; ++v) {
                        const float value = point.weight * albedo[first + v] * segments.factors[v];
                        const auto bin = static_cast<std::size_t>(segments.bins[v]);
                        padded[bin] += (1.0F - segments.late[v]) * value;
                        padded[bin + 1] += segments.late[v] * value;
                    }
                }
            }
            const auto own = histograms.subspan(i * num_bins_, num_bins_);
            blur(std::span<const float>(padded).subspan(1, num_bins_), own, false);
            const core::BinRange seen = observed_[pairs[i]];
            std::fill(own.begin(), own.begin() + seen.begin, 0.0F);
            std::fill(own.begin() + seen.end, own.end(), 0.0F);
        }
    });
}

void PairOperator::adjoint(std::span<const float> histograms,
                           std::span<const std::size_t> pairs,
                           std::span<float> albedo) const {
    // Padded by a zero before and two behind, so that light beyond the axis is lost.
    const std::size_t stride = num_bins_ + 3;
    std::vector<float> padded(pairs.size() * stride, 0.0F);
    core::parallel_for(pairs.size(), [&](std::size_t i) {
        std::vector<float> seen(num_bins_, 0.0F);
        const core::BinRange range = observed_[pairs[i]];
        const auto own = histograms.subspan(i * num_bins_, num_bins_);
        std::copy(own.begin() + range.begin, own.begin() + range.end, seen.begin() + range.begin);
        blur(seen, std::span<float>(padded).subspan(i * stride + 1, num_bins_), true);
    });
    core::parallel_blocks(num_voxels(), kVoxelsPerChunk, [&](std::size_t begin, std::size_t end) {
        Segments segments;
        float* __restrict sums = albedo.data() + begin;
        std::fill_n(sums, end - begin, 0.0F);
        for (std::size_t i = 0; i < pairs.size(); ++i) {
            const float* __restrict row = padded.data() + i * stride;
            fill_segments(pairs[i], begin, end, segments);
            for (const SpotPoint& point : spot_) {
                place(point, end - begin, segments);
                for (std::size_t v = 0; v < end - begin; ++v) {
                    const int bin = segments.bins[v];
                    const float value = row[bin] + segments.late[v] * (row[bin + 1] - row[bin]);
                    sums[v] += point.weight * segments.factors[v] * value;
                }
            }
        }
    });
}

}  // namespace nlos
