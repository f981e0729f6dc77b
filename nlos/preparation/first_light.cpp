// SPDX-License-Identifier: MIT
#include "nlos/preparation/first_light.h"

#include "nlos/preparation/wall_frame.h"
#include "renderer/core/statistics.h"
#include "renderer/core/system/parallel.h"

#include <Eigen/LU>

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

constexpr std::size_t kMinPoints = 16;
constexpr std::size_t kWindowsPerSide = 4;
constexpr double kLargestResidual_bins = 1.0;
constexpr double kLargestUncertainty = 0.05;
constexpr double kFractionBelow = 0.9;

/// First light of a grid's points, as range.
struct RangeMap {
    std::array<std::size_t, 2> size{};
    std::array<double, 2> pitch_m{};
    double bin_m = 0.0;                         ///< of range
    std::vector<std::optional<double>> ranges;  ///< [x][y]
    std::vector<bool> may_be_missing;           ///< [x][y]: not all bins were observed
};

RangeMap make_range_map(const core::Capture& capture,
                        const WallGrid& grid,
                        const std::vector<std::optional<double>>& first_light) {
    RangeMap map{grid.size, grid.pitch_m, 0.5 * capture.time_axis.bin_width_m, {}, {}};
    for (std::size_t ix = 0; ix < grid.size[0]; ++ix) {
        for (std::size_t iy = 0; iy < grid.size[1]; ++iy) {
            const std::size_t pair = grid.point(ix, iy);
            const std::optional<double>& opl = first_light[pair];
            map.ranges.push_back(opl ? std::optional(0.5 * *opl) : std::nullopt);
            map.may_be_missing.push_back(capture.observed_range(pair).size() <
                                         capture.time_axis.num_bins);
        }
    }
    return map;
}

/// The larger bend of r^2 in the window of `size` points from (x0, y0) on, if it is of use.
std::optional<BendOfFirstLight> bend_in_window(const RangeMap& map,
                                               std::array<std::size_t, 2> first,
                                               std::array<std::size_t, 2> size) {
    using Terms = Eigen::Matrix<double, 6, 1>;  // 1, x, y, x^2, y^2, x y
    Eigen::Matrix<double, 6, 6> lhs = Eigen::Matrix<double, 6, 6>::Zero();
    Terms rhs = Terms::Zero();
    double squares = 0.0;
    double mean_range_m = 0.0;
    double count = 0.0;
    for (std::size_t ix = 0; ix < size[0]; ++ix) {
        for (std::size_t iy = 0; iy < size[1]; ++iy) {
            const std::size_t at = (first[0] + ix) * map.size[1] + first[1] + iy;
            const std::optional<double>& range = map.ranges[at];
            if (!range && map.may_be_missing[at]) continue;
            if (!range) return std::nullopt;
            ++count;
            const double x =
                map.pitch_m[0] * (static_cast<double>(ix) - 0.5 * static_cast<double>(size[0] - 1));
            const double y =
                map.pitch_m[1] * (static_cast<double>(iy) - 0.5 * static_cast<double>(size[1] - 1));
            Terms terms;
            terms << 1.0, x, y, x * x, y * y, x * y;
            lhs += terms * terms.transpose();
            rhs += *range * *range * terms;
            squares += std::pow(*range, 4);
            mean_range_m += *range;
        }
    }
    if (count < 0.5 * static_cast<double>(size[0] * size[1])) return std::nullopt;
    mean_range_m /= count;
    const Eigen::Matrix<double, 6, 6> inverse = lhs.inverse();
    const Terms c = inverse * rhs;
    const double residual =
        std::sqrt(std::max(0.0, squares - c.dot(rhs)) / (count - static_cast<double>(c.size())));
    if (residual > kLargestResidual_bins * 2.0 * mean_range_m * map.bin_m) return std::nullopt;
    const double uncertainty = residual * std::sqrt(std::max(inverse(3, 3), inverse(4, 4)));
    const double larger = 0.5 * (c[3] + c[4]) + std::hypot(0.5 * (c[3] - c[4]), 0.5 * c[5]);
    if (!(uncertainty < kLargestUncertainty * std::max(1.0, larger))) return std::nullopt;
    return BendOfFirstLight{larger, uncertainty};
}

}  // namespace

std::optional<double> first_light_m(const core::Capture& capture,
                                    std::size_t pair,
                                    double ambient,
                                    double fraction) {
    const auto seen = capture.observed_values(pair);
    if (seen.empty()) return std::nullopt;
    const int first_seen = capture.observed_range(pair).begin;
    const auto excess = [&](std::size_t bin) { return static_cast<double>(seen[bin]) - ambient; };
    const Eigen::Map<const Eigen::ArrayXf> values(seen.data(),
                                                  static_cast<Eigen::Index>(seen.size()));
    const double threshold = fraction * (static_cast<double>(values.maxCoeff()) - ambient);
    if (!(threshold > 0.0)) return std::nullopt;
    std::size_t bin = 0;
    while (excess(bin) < threshold) ++bin;
    if (bin == 0 && first_seen > 0) return std::nullopt;
    const double before = bin > 0 ? excess(bin - 1) : 0.0;
    const double late = (threshold - before) / (excess(bin) - before);
    return capture.time_axis.bin_center_m(first_seen + static_cast<double>(bin) - 1.0 + late) -
           capture.scan.wall().device_segments_m(pair);
}

std::vector<std::optional<double>> first_light_m(const core::Capture& capture,
                                                 const std::vector<double>& ambient,
                                                 double fraction) {
    const core::WallScan& scan = capture.scan.wall();
    std::vector<std::optional<double>> first_light(
        std::min(scan.sensing.size(), scan.num_pairs()));  // a list may have fewer pairs
    core::parallel_for(first_light.size(), [&](std::size_t pair) {
        first_light[pair] = first_light_m(capture, pair, ambient[pair], fraction);
    });
    return first_light;
}

std::optional<BendOfFirstLight> bend_of_first_light(
    const core::Capture& capture, const std::vector<std::optional<double>>& first_light) {
    if (capture.scan.wall().pattern != core::ScanPattern::Confocal) return std::nullopt;
    const WallFrame wall = derive_wall_frame(capture.scan.wall());
    if (!wall.grid || std::min(wall.grid->size[0], wall.grid->size[1]) < kMinPoints) {
        return std::nullopt;
    }
    const RangeMap map = make_range_map(capture, *wall.grid, first_light);
    const std::array<std::size_t, 2> size{map.size[0] / kWindowsPerSide,
                                          map.size[1] / kWindowsPerSide};
    std::size_t num_windows = 0;
    std::vector<BendOfFirstLight> bends;
    for (std::size_t x = 0; x + size[0] <= map.size[0]; x += size[0] / 2) {
        for (std::size_t y = 0; y + size[1] <= map.size[1]; y += size[1] / 2) {
            ++num_windows;
            if (const auto bend = bend_in_window(map, {x, y}, size)) bends.push_back(*bend);
        }
    }
    if (2 * bends.size() < num_windows || bends.empty()) return std::nullopt;
    return core::quantile(std::move(bends), kFractionBelow, &BendOfFirstLight::k);
}

}  // namespace nlos
