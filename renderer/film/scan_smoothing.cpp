// SPDX-License-Identifier: MIT
#include "renderer/film/scan_smoothing.h"

#include "renderer/core/statistics.h"
#include "renderer/core/system/parallel.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

namespace renderer {
namespace {

constexpr int kMaxWidth = 8;
constexpr std::size_t kPairsPerBlock = 16;
// Of an axis, so that the noise that is left averages over many independent values.
constexpr std::size_t kWidthsPerAxis = 4;

using Row = Eigen::ArrayXf;
using ConstRow = Eigen::Map<const Row>;

Eigen::Map<Row> row(core::Transient& t, std::size_t pair) {
    return {t.histogram(pair).data(), static_cast<Eigen::Index>(t.num_bins())};
}
ConstRow row(const core::Transient& t, std::size_t pair) {
    return {t.histogram(pair).data(), static_cast<Eigen::Index>(t.num_bins())};
}

// One side of a grid of wall points: neighbours along it are `stride` pairs apart.
struct GridSide {
    std::size_t count = 1;
    std::size_t stride = 1;
};

std::vector<GridSide> grid_sides(const core::WallScan& scan) {
    std::vector<GridSide> sides;
    const auto add = [&](const core::WallPoints& points, std::size_t stride) {
        if (!points.grid) return;
        const auto [x, y] = *points.grid;
        sides.push_back({x, y * stride});
        sides.push_back({y, stride});
    };
    add(scan.sensing, 1);
    if (scan.pattern == core::ScanPattern::Exhaustive) add(scan.illumination, scan.sensing.size());
    return sides;
}

int width_limit(std::size_t count) {
    return std::clamp(static_cast<int>(count / kWidthsPerAxis), 1, kMaxWidth);
}

// The widest of both that a scan allows.
SmoothingWidths widest(const core::WallScan& scan, std::size_t num_bins) {
    SmoothingWidths widths{1, width_limit(num_bins)};
    const std::vector<GridSide> sides = grid_sides(scan);
    if (sides.empty()) return widths;
    widths.points = kMaxWidth;
    for (const GridSide& side : sides) {
        if (side.count > 1) widths.points = std::min(widths.points, width_limit(side.count));
    }
    return widths;
}

// Index of what lies `offset` from i when [0, count) is mirrored at both ends.
std::size_t mirrored(std::size_t i, int offset, std::size_t count) {
    const auto period = 2 * static_cast<long>(count);
    long j = (static_cast<long>(i) + offset) % period;
    if (j < 0) j += period;
    return static_cast<std::size_t>(std::min(j, period - 1 - j));
}

float weight(int offset, int width) {
    return static_cast<float>(width - std::abs(offset)) / static_cast<float>(width * width);
}

// As a plain loop, which has the same bits for values aligned in any way.
void add_scaled(float scale, const float* from, std::span<float> to) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] += scale * from[i];
}

core::Transient smooth_points(const core::Transient& from, const GridSide& side, int width) {
    core::Transient to(from.num_pairs(), static_cast<int>(from.num_bins()));
    core::parallel_blocks(
        from.num_pairs(), kPairsPerBlock, [&](std::size_t begin, std::size_t end) {
            for (std::size_t pair = begin; pair < end; ++pair) {
                const std::size_t i = pair / side.stride % side.count;
                for (int offset = 1 - width; offset < width; ++offset) {
                    const std::size_t j = mirrored(i, offset, side.count);
                    const std::size_t neighbour = pair - i * side.stride + j * side.stride;
                    add_scaled(weight(offset, width),
                               from.histogram(neighbour).data(),
                               to.histogram(pair));
                }
            }
        });
    return to;
}

core::Transient smooth_bins(const core::Transient& from, int width) {
    core::Transient to(from.num_pairs(), static_cast<int>(from.num_bins()));
    const std::size_t bins = from.num_bins();
    core::parallel_blocks(
        from.num_pairs(), kPairsPerBlock, [&](std::size_t begin, std::size_t end) {
            const int margin = width - 1;
            std::vector<float> padded(bins + static_cast<std::size_t>(2 * margin));
            for (std::size_t pair = begin; pair < end; ++pair) {
                const std::span<const float> values = from.histogram(pair);
                for (std::size_t i = 0; i < padded.size(); ++i) {
                    padded[i] = values[mirrored(0, static_cast<int>(i) - margin, bins)];
                }
                for (int offset = -margin; offset <= margin; ++offset) {
                    add_scaled(weight(offset, width),
                               padded.data() + (offset + margin),
                               to.histogram(pair));
                }
            }
        });
    return to;
}

// The squared bias of smoothing, at one standard deviation above its estimate.
double squared_bias(const core::Transient& mean,
                    const core::Transient& smooth_mean,
                    const core::Transient& difference,
                    const core::Transient& smooth_difference) {
    using Moments = Eigen::Array2d;  // sums over pairs, and of squares
    const std::size_t count = mean.num_pairs();
    const Moments sums = core::parallel_sum<Moments>(count, Moments::Zero(), [&](std::size_t pair) {
        const auto lost_by = [&](const core::Transient& a, const core::Transient& b) {
            return (row(a, pair) - row(b, pair)).cast<double>().square().sum();
        };
        const double of_pair =
            lost_by(mean, smooth_mean) - 0.25 * lost_by(difference, smooth_difference);
        return Moments(of_pair, of_pair * of_pair);
    });
    const auto n = static_cast<double>(count);
    const double variance =
        std::max(0.0, sums[1] - sums[0] * sums[0] / n) * n / std::max(1.0, n - 1);
    return std::max(0.0, sums[0]) + std::sqrt(variance);
}

}  // namespace

core::Transient smooth_scan(const core::Transient& transient,
                            const core::WallScan& scan,
                            const SmoothingWidths& widths) {
    core::Transient result = transient;
    if (widths.points > 1) {
        for (const GridSide& side : grid_sides(scan)) {
            if (side.count > 1) result = smooth_points(result, side, widths.points);
        }
    }
    return widths.bins > 1 ? smooth_bins(result, widths.bins) : result;
}

SmoothedMean smooth_mean(const core::Transient& a,
                         const core::Transient& b,
                         const core::WallScan& scan,
                         const core::Transient* precomputed) {
    core::Transient mean(a.num_pairs(), static_cast<int>(a.num_bins()));
    core::Transient difference = mean;
    core::parallel_for(a.num_pairs(), [&](std::size_t pair) {
        row(mean, pair) = 0.5F * (row(a, pair) + row(b, pair));
        row(difference, pair) = row(a, pair) - row(b, pair);
    });
    const auto smoothed_by = [&](const SmoothingWidths& widths) {
        SmoothedMean result{smooth_scan(mean, scan, widths), widths};
        const core::Transient rest = smooth_scan(difference, scan, widths);
        result.squared_noise = 0.25 * core::squared_norm(rest.values());
        result.squared_error = result.squared_noise;
        if (!widths.is_none()) {
            result.squared_error += squared_bias(mean, result.mean, difference, rest);
        }
        return result;
    };
    const SmoothingWidths limits = widest(scan, a.num_bins());
    SmoothedMean best = smoothed_by({});
    const auto widen = [&](int SmoothingWidths::*width) {
        SmoothingWidths wider = best.widths;
        wider.*width *= 2;
        if (wider.*width > limits.*width) return false;
        SmoothedMean result = smoothed_by(wider);
        const bool is_better = result.squared_error < best.squared_error;
        if (is_better) best = std::move(result);
        return is_better;
    };
    while (widen(&SmoothingWidths::points)) {
    }
    while (widen(&SmoothingWidths::bins)) {
    }
    // The product of two independent estimates has no bias from their noise.
    const double squared_noise = 0.25 * core::squared_norm(difference.values());
    if (precomputed != nullptr) mean += *precomputed;
    best.squared_signal = std::max(0.0, core::squared_norm(mean.values()) - squared_noise);
    return best;
}

}  // namespace renderer
