// SPDX-License-Identifier: MIT
#include "nlos/layouts/layout_histograms.h"
#include "renderer/core/error.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>

namespace nlos {
namespace {

using core::Error;
using core::Vec3;

/// The histograms' axes along which points of one kind lie.
PointAxes point_axes(const LayoutFiles& files,
                     const HistogramArray& array,
                     const std::vector<std::string>& names) {
    PointAxes axes;
    axes.reversed = array.reversed;
    axes.first_index_fastest = files.first_index_fastest(array.name);
    for (std::size_t i = 0; i < array.axes.size(); ++i) {
        if (std::find(names.begin(), names.end(), array.axes[i]) == names.end()) continue;
        axes.names.push_back(array.axes[i]);
        axes.extents.push_back(array.extents[i]);
    }
    return axes;
}

core::ScanPattern pattern_of(const Layout& layout,
                             const core::WallScan& scan,
                             const PairNumbers& numbers,
                             bool has_illumination_axes) {
    switch (layout.pattern) {
        case LayoutPattern::Single:
            return core::ScanPattern::Single;
        case LayoutPattern::Confocal:
            return core::ScanPattern::Confocal;
        case LayoutPattern::Exhaustive:
            return core::ScanPattern::Exhaustive;
        case LayoutPattern::ByPoints:
            break;
    }
    const bool pairwise = !has_illumination_axes && numbers.illumination.size() > 1;
    if (pairwise && are_same_points(scan.sensing, scan.illumination) &&
        numbers.sensing == numbers.illumination) {
        return core::ScanPattern::Confocal;
    }
    return scan.illumination.size() == 1 ? core::ScanPattern::Single
                                         : core::ScanPattern::Exhaustive;
}

void require_every_pair_once(const LayoutFiles& files,
                             const PairNumbers& numbers,
                             std::size_t num_pairs) {
    const std::size_t lit =
        numbers.listed ? 1 : std::max<std::size_t>(numbers.illumination.size(), 1);
    const bool exhaustive = numbers.pattern == core::ScanPattern::Exhaustive;
    std::vector<bool> seen(num_pairs, false);
    std::size_t entries = 0;
    for (std::size_t l = 0; l < (exhaustive ? lit : 1); ++l) {
        for (std::size_t s = 0; s < numbers.sensing.size(); ++s, ++entries) {
            const std::size_t pair = numbers.pair(l, s);
            if (pair >= num_pairs || seen[pair]) {
                throw Error(files.path(),
                            fmt::format("histogram {} repeats an earlier pair of points", entries),
                            "must have every pair once");
            }
            seen[pair] = true;
        }
    }
    if (entries != num_pairs) {
        throw Error(files.path(),
                    fmt::format("has {} histograms for {} pairs of points", entries, num_pairs),
                    "must pair every illumination with every sensing point, or be confocal");
    }
}

}  // namespace

bool are_same_points(const core::WallPoints& a, const core::WallPoints& b) {
    constexpr double kTolerance_m = 1e-5;  // files hold single precision
    if (a.size() != b.size()) return false;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (!((a.positions[i] - b.positions[i]).norm() <= kTolerance_m)) return false;
    }
    return true;
}

PairNumbers read_pairs(const LayoutFiles& files,
                       const Layout& layout,
                       const HistogramArray& array,
                       const CaptureReadSettings& settings,
                       core::WallScan& scan) {
    // The devices stand on the side of the wall on which the hidden scene is.
    const std::optional<Vec3> towards =
        scan.opl_origin == core::OplOrigin::Device
            ? std::optional<Vec3>(0.5 * (scan.laser_position + scan.detector_position))
            : std::nullopt;
    const PointAxes sensed = point_axes(files, array, {"x", "y", "sx", "sy", "s", "pair"});
    PlacedPoints sensing =
        place_points(files, layout.sensing, sensed, settings, towards, "sensing");
    PairNumbers numbers;
    numbers.sensing = std::move(sensing.of_entry);
    numbers.num_sensing = sensing.points.size();
    numbers.listed = array.extent("pair").has_value();
    scan.sensing = std::move(sensing.points);

    PointAxes lit = point_axes(files, array, {"lx", "ly", "l"});
    const bool has_illumination_axes = !lit.names.empty();
    if (numbers.listed || (layout.pattern == LayoutPattern::ByPoints && !has_illumination_axes)) {
        lit = sensed;  // each histogram has its own of both
    }
    if (layout.pattern == LayoutPattern::Confocal) {
        scan.illumination = scan.sensing;
        numbers.illumination = numbers.sensing;
    } else if (!layout.illumination.index.empty()) {
        std::vector<double> index = files.read(layout.illumination.index);
        if (sensed.names.size() == 2 && sensed.names[0].back() == 'y') {
            std::reverse(index.begin(), index.end());
        }
        const auto grid = scan.sensing.grid.value_or(std::array<std::size_t, 2>{0, 0});
        const bool inside = index.size() == 2 && index[0] >= 1 && index[1] >= 1 &&
                            index[0] <= static_cast<double>(grid[0]) &&
                            index[1] <= static_cast<double>(grid[1]);
        if (!inside) {
            throw Error(
                files.where(layout.illumination.index),
                fmt::format("found ({})", fmt::join(index, ", ")),
                fmt::format(
                    "must be a point of the {} x {} grid, counted from 1", grid[0], grid[1]));
        }
        const auto number = (static_cast<std::size_t>(index[0]) - 1) * grid[1] +
                            static_cast<std::size_t>(index[1]) - 1;
        scan.illumination = {{scan.sensing.positions[number]}, {scan.sensing.normals[number]}, {}};
        numbers.illumination = {0};
    } else {
        PlacedPoints placed =
            place_points(files, layout.illumination, lit, settings, towards, "illumination");
        scan.illumination = std::move(placed.points);
        numbers.illumination = std::move(placed.of_entry);
    }
    scan.pattern = pattern_of(layout, scan, numbers, has_illumination_axes);
    numbers.pattern = scan.pattern;
    require_every_pair_once(files, numbers, scan.num_pairs());
    return numbers;
}

}  // namespace nlos
