// SPDX-License-Identifier: MIT
// Single and exhaustive scans as the confocal ones that they resemble; see prepared_capture.h.
#include "nlos/preparation/conservative_resampling.h"
#include "nlos/preparation/memory_limit.h"
#include "nlos/preparation/prepared_capture.h"
#include "renderer/core/error.h"
#include "renderer/core/system/parallel.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace nlos {
namespace {

/// A grid of half the sensing pitch that covers all midpoints, and who lands where.
struct MidpointGrid {
    std::array<std::size_t, 2> size{};
    std::array<double, 2> first_m{};
    std::array<double, 2> pitch_m{};
    std::vector<std::vector<std::size_t>> pairs;  ///< per grid point, x before y
};

core::Vec3 midpoint(const core::WallScan& scan, std::size_t pair) {
    return 0.5 * (scan.illumination_point(pair) + scan.sensing_point(pair));
}

std::optional<MidpointGrid> find_midpoint_grid(const core::WallScan& scan, const WallFrame& wall) {
    if (!wall.grid) return std::nullopt;
    const core::Transform wall_from_world = wall.world_from_wall.inverse(Eigen::Isometry);
    std::vector<Eigen::Vector2d> midpoints(scan.num_pairs());
    Eigen::Vector2d low = Eigen::Vector2d::Constant(1e300);
    Eigen::Vector2d high = -low;
    for (std::size_t pair = 0; pair < midpoints.size(); ++pair) {
        midpoints[pair] = (wall_from_world * midpoint(scan, pair)).head<2>();
        low = low.cwiseMin(midpoints[pair]);
        high = high.cwiseMax(midpoints[pair]);
    }
    MidpointGrid grid;
    for (int axis = 0; axis < 2; ++axis) {
        grid.pitch_m[axis] = 0.5 * wall.grid->pitch_m[axis];
        grid.first_m[axis] = low[axis];
        grid.size[axis] =
            static_cast<std::size_t>(std::llround((high[axis] - low[axis]) / grid.pitch_m[axis])) +
            1;
    }
    // Fewer pairs than points cannot fill the grid, which far-off points would make huge.
    if (static_cast<double>(grid.size[0]) * static_cast<double>(grid.size[1]) >
        static_cast<double>(midpoints.size())) {
        return std::nullopt;
    }
    grid.pairs.resize(grid.size[0] * grid.size[1]);
    for (std::size_t pair = 0; pair < midpoints.size(); ++pair) {
        std::array<std::size_t, 2> at{};
        for (int axis = 0; axis < 2; ++axis) {
            const double position =
                (midpoints[pair][axis] - grid.first_m[axis]) / grid.pitch_m[axis];
            at[axis] = std::min(grid.size[axis] - 1,
                                static_cast<std::size_t>(std::llround(std::max(0.0, position))));
        }
        grid.pairs[at[0] * grid.size[1] + at[1]].push_back(pair);
    }
    const bool is_full = std::none_of(
        grid.pairs.begin(), grid.pairs.end(), [](const auto& pairs) { return pairs.empty(); });
    return is_full ? std::optional(grid) : std::nullopt;
}

core::WallPoints wall_points(const MidpointGrid& grid, const WallFrame& wall) {
    core::WallPoints points;
    points.grid = grid.size;
    for (std::size_t ix = 0; ix < grid.size[0]; ++ix) {
        for (std::size_t iy = 0; iy < grid.size[1]; ++iy) {
            points.positions.push_back(
                wall.world_from_wall *
                core::Vec3(grid.first_m[0] + static_cast<double>(ix) * grid.pitch_m[0],
                           grid.first_m[1] + static_cast<double>(iy) * grid.pitch_m[1],
                           0.0));
        }
    }
    points.normals.assign(points.size(), wall.world_from_wall.linear().col(2));
    return points;
}

/// The confocal axis starts at 0 and ends where the last bin can land. An axis that starts far from
/// the wall fills much with darkness: refused before it is made.
core::TimeAxis confocal_axis(const core::WallScan& scan,
                             core::TimeAxis axis,
                             std::size_t num_points) {
    const double shortest = core::device_segment_range_m(scan)[0];
    const double end = std::max(axis.bin_width_m, axis.opl_end_m() - shortest);
    const double num_bins = std::ceil(end / axis.bin_width_m - 1e-6);
    require_memory(4.0 * static_cast<double>(num_points) * num_bins);
    if (num_bins > std::numeric_limits<int>::max()) {
        throw core::Error("capture",
                          fmt::format("the time axis ends {:.4g} m behind the wall", end),
                          "must end nearer for its midpoints' axis, which starts at the wall");
    }
    axis.opl_start_m = 0.0;
    axis.num_bins = static_cast<int>(num_bins);
    return axis;
}

/// The bin edges of a pair as confocal path lengths.
std::vector<double> moved_edges(const core::WallScan& scan,
                                const core::TimeAxis& axis,
                                std::size_t pair) {
    const double offset = (scan.illumination_point(pair) - scan.sensing_point(pair)).norm();
    std::vector<double> edges(static_cast<std::size_t>(axis.num_bins) + 1);
    for (std::size_t bin = 0; bin < edges.size(); ++bin) {
        const double opl =
            axis.bin_begin_m(static_cast<double>(bin)) - scan.device_segments_m(pair);
        edges[bin] = opl > offset ? std::sqrt((opl - offset) * (opl + offset)) : 0.0;
    }
    return edges;
}

/// Turns sums over pairs into means over those that observed a bin.
///
/// seen      per bin, how many pairs observed it, the last ones in part
/// returns   the longest run of bins seen well enough; all others become 0
core::BinRange take_means(const std::vector<double>& seen, std::span<float> sums) {
    constexpr double kSeenEnough = 0.5;  // of one pair's bin
    core::BinRange best;
    core::BinRange run;
    for (int bin = 0; bin < static_cast<int>(sums.size()); ++bin) {
        const auto at = static_cast<std::size_t>(bin);
        if (seen[at] < kSeenEnough) continue;
        run = run.end == bin ? core::BinRange{run.begin, bin + 1} : core::BinRange{bin, bin + 1};
        if (run.size() > best.size()) best = run;
        sums[at] = static_cast<float>(static_cast<double>(sums[at]) / seen[at]);
    }
    for (int bin = 0; bin < static_cast<int>(sums.size()); ++bin) {
        if (!best.holds(bin)) sums[static_cast<std::size_t>(bin)] = 0.0F;
    }
    return best;
}

/// Adds the fraction of each bin that lies between two lengths.
void add_fractions(const std::vector<double>& edges,
                   double begin,
                   double end,
                   std::vector<double>& to) {
    for (std::size_t bin = 0; bin < to.size(); ++bin) {
        const double overlap = std::min(end, edges[bin + 1]) - std::max(begin, edges[bin]);
        to[bin] += std::max(0.0, overlap) / (edges[bin + 1] - edges[bin]);
    }
}

/// Fills the mean histograms of the pairs at each midpoint, and what of them was observed where
/// not all bins were.
void fill_means(const PreparedCapture& from,
                const MidpointGrid& grid,
                const core::TimeAxis& axis,
                core::Transient& means,
                core::ObservedBins& seen_bins) {
    const auto num_bins = static_cast<std::size_t>(axis.num_bins);
    const std::vector<double> edges = even_edges(0.0, axis.opl_end_m(), num_bins);
    core::parallel_for(grid.pairs.size(), [&](std::size_t point) {
        const auto sum = means.histogram(point);
        const std::vector<std::size_t>& pairs = grid.pairs[point];
        const double fraction = from.observed ? 1.0 : 1.0 / static_cast<double>(pairs.size());
        const std::vector<double> fractions(from.transient().num_bins(), fraction);
        std::vector<float> moved(num_bins);
        std::vector<double> seen(num_bins);
        for (const std::size_t pair : pairs) {
            const std::vector<double> pair_edges = moved_edges(from.scan, from.time_axis, pair);
            ConservativeResampling(pair_edges, edges, fractions)
                .apply(from.transient().histogram(pair).data(), moved.data());
            for (std::size_t bin = 0; bin < num_bins; ++bin) sum[bin] += moved[bin];
            if (!from.observed) continue;
            const core::BinRange& range = (*from.observed)[pair];
            add_fractions(edges,
                          pair_edges[static_cast<std::size_t>(range.begin)],
                          pair_edges[static_cast<std::size_t>(range.end)],
                          seen);
        }
        if (from.observed) (*seen_bins)[point] = take_means(seen, sum);
    });
}

}  // namespace

bool convert_to_confocal(PreparedCapture& prepared) {
    const std::optional<MidpointGrid> grid = find_midpoint_grid(prepared.scan, prepared.wall);
    if (!grid) return false;
    const std::size_t num_points = grid->pairs.size();
    const core::TimeAxis axis = confocal_axis(prepared.scan, prepared.time_axis, num_points);
    core::Transient means(num_points, axis.num_bins);
    core::ObservedBins observed;
    if (prepared.observed) observed.emplace(num_points);
    fill_means(prepared, *grid, axis, means, observed);
    prepared.conversion = fmt::format(
        "{} scan converted to {} x {} confocal midpoints",
        prepared.scan.pattern == core::ScanPattern::Single ? "single-laser" : "exhaustive",
        grid->size[0],
        grid->size[1]);
    prepared.scan = core::WallScan{};
    prepared.scan.sensing = wall_points(*grid, prepared.wall);
    prepared.scan.illumination = prepared.scan.sensing;
    prepared.time_axis = axis;
    prepared.own = std::move(means);
    prepared.observed = std::move(observed);
    if (prepared.observed) drop_unobserved_ends(prepared);
    prepared.wall = derive_wall_frame(prepared.scan);
    return true;
}

}  // namespace nlos
