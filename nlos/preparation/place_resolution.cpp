// SPDX-License-Identifier: MIT
#include "nlos/preparation/place_resolution.h"

#include "nlos/preparation/histogram_preparation.h"
#include "nlos/preparation/histogram_sample.h"

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace nlos {
namespace {

/// Half the path length, device segments taken off, that half of all light comes before.
std::optional<double> middle_range_m(const PreparedCapture& prepared) {
    const auto signal = find_signal(prepared.transient(), prepared.observed, prepared.unit);
    std::vector<double> light =
        light_per_bin(prepared.transient(),
                      prepared.observed ? &*prepared.observed : nullptr,
                      signal ? signal->ambient_per_bin : std::vector<double>());
    std::partial_sum(light.begin(), light.end(), light.begin());
    const double all = light.empty() ? 0.0 : *std::ranges::max_element(light);
    if (!(all > 0.0)) return std::nullopt;
    const auto found = std::ranges::find_if(light, [&](double sum) { return sum >= 0.5 * all; });
    const auto [shortest, longest] = core::device_segment_range_m(prepared.scan);
    const double length =
        prepared.time_axis.bin_center_m(static_cast<double>(found - light.begin()));
    return 0.5 * (length - 0.5 * (shortest + longest));
}

}  // namespace

PlaceResolution::PlaceResolution(const core::WallScan& scan, double told_m) : told_m_(told_m) {
    for (const std::size_t pair : sampled_pairs(scan)) {
        illumination_.push_back(scan.illumination_point(pair));
        sensing_.push_back(scan.sensing_point(pair));
    }
}

double PlaceResolution::at(const core::Vec3& place) const {
    core::Mat3 squares = core::Mat3::Zero();
    for (std::size_t i = 0; i < sensing_.size(); ++i) {
        const core::Vec3 gradient =
            (place - illumination_[i]).normalized() + (place - sensing_[i]).normalized();
        squares += gradient * gradient.transpose();
    }
    const Eigen::SelfAdjointEigenSolver<core::Mat3> solver(squares, Eigen::EigenvaluesOnly);
    constexpr double kRounding = 1e-12;
    const double least = solver.eigenvalues()[0] / static_cast<double>(sensing_.size());
    return least > kRounding ? told_m_ / std::sqrt(least) : std::numeric_limits<double>::infinity();
}

std::optional<LightResolution> resolve_light(const PreparedCapture& prepared) {
    const std::optional<double> range_m = middle_range_m(prepared);
    if (!range_m || !(*range_m > 0.0)) return std::nullopt;
    const PlaceResolution resolution(prepared.scan, prepared.time_axis.bin_width_m);
    return LightResolution{
        *range_m, resolution.at(prepared.wall.world_from_wall * core::Vec3(0.0, 0.0, *range_m))};
}

std::optional<std::string> why_no_directions(const PreparedCapture& prepared) {
    if (!prepared.light) return std::nullopt;
    const auto& [range_m, resolution_m] = *prepared.light;
    const WallFrame& wall = prepared.wall;
    const double width_m = wall.max_m[0] - wall.min_m[0];
    const double height_m = wall.max_m[1] - wall.min_m[1];
    if (resolution_m <= std::max(width_m, height_m)) return std::nullopt;
    return fmt::format("wall points over {:.3g} x {:.3g} m tell places {:.2g} m away {}",
                       width_m,
                       height_m,
                       range_m,
                       std::isfinite(resolution_m)
                           ? fmt::format("to no better than {:.2g} m", resolution_m)
                           : "in no more than two directions");
}

}  // namespace nlos
