// SPDX-License-Identifier: MIT
#include "nlos/preparation/prepared_capture.h"

#include "nlos/preparation/grid_order.h"
#include "nlos/preparation/memory_limit.h"
#include "renderer/core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

using Limits = std::optional<std::array<double, 2>>;

bool holds(const Limits& limits, double value) {
    return !limits || (value >= (*limits)[0] && value <= (*limits)[1]);
}

/// Numbers of the points inside the crop, in order, and the grid they form if any.
struct Selection {
    std::vector<std::size_t> numbers;
    core::WallPoints points;
};

Selection select_points(const core::WallPoints& points,
                        const core::Transform& wall_from_world,
                        const CropSettings& crop) {
    Selection selection;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const core::Vec3 position = wall_from_world * points.positions[i];
        if (!holds(crop.x_range_m, position.x()) || !holds(crop.y_range_m, position.y())) continue;
        selection.numbers.push_back(i);
        selection.points.positions.push_back(points.positions[i]);
        selection.points.normals.push_back(points.normals[i]);
    }
    if (!points.grid || selection.numbers.empty()) return selection;
    // A rectangle cut out of a grid: whole runs of columns in whole runs of rows.
    const std::size_t ny = (*points.grid)[1];
    const std::size_t first_row = selection.numbers.front() / ny;
    const std::size_t rows = selection.numbers.back() / ny - first_row + 1;
    const std::size_t columns = selection.numbers.size() / rows;
    const std::size_t first_column = selection.numbers.front() % ny;
    bool is_rectangle = columns * rows == selection.numbers.size();
    for (std::size_t i = 0; i < selection.numbers.size() && is_rectangle; ++i) {
        is_rectangle =
            selection.numbers[i] == (first_row + i / columns) * ny + first_column + i % columns;
    }
    if (is_rectangle) selection.points.grid = {rows, columns};
    return selection;
}

/// Bins whose centres lie within the limits.
core::BinRange select_bins(const core::TimeAxis& axis, const Limits& limits) {
    if (!limits) return {0, axis.num_bins};
    const auto bin_at = [&](double opl) {
        const double bin = std::ceil((opl - axis.opl_start_m) / axis.bin_width_m - 0.5);
        return static_cast<int>(std::clamp(bin, 0.0, static_cast<double>(axis.num_bins)));
    };
    return {bin_at((*limits)[0]), bin_at((*limits)[1])};
}

/// A part of an axis.
core::TimeAxis axis_of(const core::TimeAxis& axis, const core::BinRange& bins) {
    return {axis.bin_begin_m(bins.begin), axis.bin_width_m, bins.size()};
}

/// Observed bins on that part, which holds all of them.
void move_observed(const core::BinRange& bins, core::ObservedBins& observed) {
    if (!observed) return;
    for (core::BinRange& range : *observed) {
        if (range.size() > 0) range = {range.begin - bins.begin, range.end - bins.begin};
    }
    core::simplify(observed, bins.size());
}

/// The bins that some of the pairs observed.
core::BinRange bins_seen(const core::ObservedBins& observed, int num_bins) {
    const core::BinRange seen = core::observed_hull(observed, num_bins);
    if (seen.size() > 0) return seen;
    throw core::Error("capture",
                      "found no observed bin of the points that are used",
                      "must have been observed somewhere");
}

/// Copies a part of some histograms, without bins that none of them observed at either end.
void take_histograms(const core::Capture& capture,
                     const std::vector<std::size_t>& pairs,
                     core::BinRange bins,
                     PreparedCapture& prepared) {
    prepared.observed.reset();
    if (capture.observed) {
        std::vector<core::BinRange>& observed = prepared.observed.emplace();
        for (const std::size_t pair : pairs) {
            observed.push_back(core::intersection((*capture.observed)[pair], bins));
        }
        const int first = bins.begin;
        bins = bins_seen(prepared.observed, capture.time_axis.num_bins);
        prepared.unobserved_before_m = (bins.begin - first) * capture.time_axis.bin_width_m;
        move_observed(bins, prepared.observed);
    }
    prepared.time_axis = axis_of(capture.time_axis, bins);
    require_memory(4.0 * static_cast<double>(pairs.size()) * bins.size());
    prepared.own = core::Transient(pairs.size(), bins.size());
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const auto from = capture.transient.histogram(pairs[i]);
        std::copy_n(from.begin() + bins.begin, bins.size(), prepared.own.histogram(i).begin());
    }
}

/// numbers   of the pairs of the prepared scan in the capture
void crop_measurement(const core::Capture& capture,
                      const CropSettings& crop,
                      const std::vector<std::size_t>& numbers,
                      PreparedCapture& prepared) {
    const core::WallScan scan = prepared.scan;
    const core::Transform wall_from_world = prepared.wall.world_from_wall.inverse(Eigen::Isometry);
    const Selection sensing = select_points(scan.sensing, wall_from_world, crop);
    const bool is_exhaustive = scan.pattern == core::ScanPattern::Exhaustive;
    const Selection lit =
        is_exhaustive ? select_points(scan.illumination, wall_from_world, crop) : Selection{};
    core::BinRange bins = select_bins(capture.time_axis, crop.opl_range_m);
    if (sensing.numbers.empty() || (is_exhaustive && lit.numbers.empty()) || bins.size() <= 0) {
        throw core::Error("crop",
                          fmt::format("leaves {} sensing points and {} bins",
                                      sensing.numbers.size(),
                                      std::max(0, bins.size())),
                          "must leave some of each; ranges are in the wall's frame, around the "
                          "centre of its points");
    }
    prepared.scan.sensing = sensing.points;
    if (scan.pattern == core::ScanPattern::Confocal) prepared.scan.illumination = sensing.points;
    if (is_exhaustive) prepared.scan.illumination = lit.points;
    std::vector<std::size_t> pairs;  // of the capture
    for (std::size_t pair = 0; pair < prepared.scan.num_pairs(); ++pair) {
        const std::size_t s = sensing.numbers[pair % sensing.numbers.size()];
        const std::size_t l = is_exhaustive ? lit.numbers[pair / sensing.numbers.size()] : 0;
        pairs.push_back(numbers[l * scan.sensing.size() + s]);
    }
    take_histograms(capture, pairs, bins, prepared);
    prepared.wall = derive_wall_frame(prepared.scan);
}

}  // namespace

PreparedCapture crop_capture(const core::Capture& capture, const CropSettings& crop) {
    PreparedCapture prepared;
    prepared.scan = capture.scan.wall();
    prepared.time_axis = capture.time_axis;
    prepared.unit = capture.unit;
    prepared.capture_transient = &capture.transient;
    prepared.observed = capture.observed;
    const std::vector<std::size_t> numbers = sort_into_grids(prepared.scan);
    prepared.wall = derive_wall_frame(prepared.scan);
    const bool has_blind_ends =
        core::observed_hull(capture.observed, capture.time_axis.num_bins).size() <
        capture.time_axis.num_bins;
    if (crop.x_range_m || crop.y_range_m || crop.opl_range_m || has_blind_ends ||
        !std::ranges::is_sorted(numbers)) {
        crop_measurement(capture, crop, numbers, prepared);
    }
    core::WallScan& scan = prepared.scan;
    if (scan.pattern == core::ScanPattern::Exhaustive && scan.sensing.size() == 1) {
        // Light takes the same way back: swap the roles; the histograms keep their order.
        std::swap(scan.illumination, scan.sensing);
        std::swap(scan.laser_position, scan.detector_position);
        scan.pattern = core::ScanPattern::Single;
    }
    return prepared;
}

void drop_unobserved_ends(PreparedCapture& prepared) {
    const core::BinRange bins = bins_seen(prepared.observed, prepared.time_axis.num_bins);
    core::Transient shorter(prepared.own.num_pairs(), bins.size());
    for (std::size_t pair = 0; pair < shorter.num_pairs(); ++pair) {
        std::copy_n(prepared.own.histogram(pair).begin() + bins.begin,
                    bins.size(),
                    shorter.histogram(pair).begin());
    }
    prepared.own = std::move(shorter);
    prepared.unobserved_before_m = bins.begin * prepared.time_axis.bin_width_m;
    prepared.time_axis = axis_of(prepared.time_axis, bins);
    move_observed(bins, prepared.observed);
}

}  // namespace nlos
