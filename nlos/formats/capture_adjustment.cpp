// SPDX-License-Identifier: MIT
#include "nlos/formats/capture_file.h"
#include "renderer/core/capture/masked_bins.h"
#include "renderer/core/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>

namespace nlos {
namespace {

using core::Capture;
using core::WallPoints;

void set_wall_size(const std::array<double, 2>& size_m, Capture& capture) {
    core::WallScan& scan = capture.scan.wall();
    const core::ScanExtent extent = core::scan_extent(scan);
    for (WallPoints* points : {&scan.sensing, &scan.illumination}) {
        if (points->size() < 2) continue;
        for (int i = 0; i < 2; ++i) {
            if (!(extent.size_m[i] > 0.0)) continue;
            const double growth = size_m[i] / extent.size_m[i] - 1.0;
            for (core::Vec3& position : points->positions) {
                const double offset = extent.axes[i].dot(position) - extent.middle_m[i];
                position += growth * offset * extent.axes[i];
            }
        }
    }
    capture.notes.push_back(
        fmt::format("the scanned points extend over {} x {} m, as told", size_m[0], size_m[1]));
}

/// Where the histogram of each point stands in the file.
std::vector<std::size_t> stored_order(const WallPoints& points,
                                      const CaptureReadSettings& settings,
                                      const std::string& where) {
    std::vector<std::size_t> order(points.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    if (points.size() < 2) return order;
    if (!points.grid) {
        throw core::Error(
            where,
            "has a list of wall points",
            "must have a grid for capture.swap_xy, capture.flip_x and capture.flip_y");
    }
    const auto [nx, ny] = *points.grid;
    for (std::size_t ix = 0; ix < nx; ++ix) {
        for (std::size_t iy = 0; iy < ny; ++iy) {
            const std::size_t x = settings.flip_x ? nx - 1 - ix : ix;
            const std::size_t y = settings.flip_y ? ny - 1 - iy : iy;
            order[ix * ny + iy] = settings.swap_xy ? y * nx + x : x * ny + y;
        }
    }
    return order;
}

void move_histograms(const CaptureReadSettings& settings,
                     const std::string& where,
                     Capture& capture) {
    const core::WallScan& scan = capture.scan.wall();
    const std::vector<std::size_t> sensed = stored_order(scan.sensing, settings, where);
    std::vector<std::size_t> lit{0};
    if (scan.is_exhaustive()) {
        lit = stored_order(scan.illumination, settings, where);
    }
    const auto stored_pair = [&](std::size_t pair) {
        return lit[pair / sensed.size()] * sensed.size() + sensed[pair % sensed.size()];
    };
    const auto move = [&](const char*, core::Transient& transient, int) {
        const core::Transient stored = transient;
        for (std::size_t pair = 0; pair < stored.num_pairs(); ++pair) {
            std::ranges::copy(stored.histogram(stored_pair(pair)),
                              transient.histogram(pair).begin());
        }
    };
    core::for_each_transient(capture, move);
    if (capture.velocity && !capture.velocity->axis.with_time) {
        move("velocity", capture.velocity->values, 1);
        if (capture.velocity->variance) move("velocity_variance", *capture.velocity->variance, 1);
    }
    core::for_each_observed(capture, [&](std::vector<core::BinRange>& ranges) {
        const std::vector<core::BinRange> stored = ranges;
        for (std::size_t pair = 0; pair < stored.size(); ++pair) {
            ranges[pair] = stored[stored_pair(pair)];
        }
    });
    std::string told;
    for (const auto& [is_set, name] : {std::pair(settings.swap_xy, "capture.swap_xy"),
                                       std::pair(settings.flip_x, "capture.flip_x"),
                                       std::pair(settings.flip_y, "capture.flip_y")}) {
        if (is_set) told += (told.empty() ? "" : ", ") + std::string(name);
    }
    capture.notes.push_back("histograms are moved between wall points by " + told);
}

void reverse_time(Capture& capture) {
    const auto bins = static_cast<std::size_t>(capture.time_axis.num_bins);
    core::for_each_transient(capture, [&](const char*, core::Transient& transient, int) {
        const auto values = transient.values();
        for (std::size_t begin = 0; begin < values.size(); begin += bins) {
            std::ranges::reverse(values.subspan(begin, bins));
        }
    });
    const int num_bins = capture.time_axis.num_bins;
    core::for_each_observed(capture, [&](std::vector<core::BinRange>& ranges) {
        for (core::BinRange& range : ranges) range = {num_bins - range.end, num_bins - range.begin};
    });
    capture.notes.emplace_back("histograms are reversed in time by capture.flip_t");
}

void set_origin(core::OplOrigin origin, Capture& capture) {
    capture.scan.wall().opl_origin = origin;
    capture.notes.push_back(
        fmt::format("path lengths {} the segments to laser and detector, as told",
                    origin == core::OplOrigin::Device ? "include" : "exclude"));
}

void set_unit(core::TransientUnit unit, Capture& capture) {
    if (unit == core::TransientUnit::Radiance) capture.counts_per_radiance.reset();
    capture.unit = unit;
    capture.notes.push_back(fmt::format("histograms hold {}, as told", core::enum_name(unit)));
}

void require_numbers(const std::vector<int>& numbers, std::size_t count, const std::string& what) {
    for (const int number : numbers) {
        core::require(number >= 0 && static_cast<std::size_t>(number) < count,
                      "capture.mask_" + what,
                      fmt::format("{}", number),
                      fmt::format("a number from 0 to {}", count - 1));
    }
}

/// Leaves out bins of all pairs, and all bins of the pairs of some sensing points.
void mask(const CaptureReadSettings& settings, const std::string& where, Capture& capture) {
    const auto num_bins = static_cast<std::size_t>(capture.time_axis.num_bins);
    require_numbers(settings.mask_bins, num_bins, "bins");
    std::vector<int> bins = settings.mask_bins;
    std::ranges::sort(bins);
    core::MaskedBins masked;
    for (std::size_t pair = 0; pair < capture.scan.num_pairs() && !bins.empty(); ++pair) {
        masked[pair] = bins;
    }
    if (!settings.mask_points.empty()) {
        if (!capture.scan.has_wall()) {
            throw core::Error(where,
                              "is the image of a camera",
                              "must be a scan of a relay wall for capture.mask_points");
        }
        const core::WallScan& scan = capture.scan.wall();
        require_numbers(settings.mask_points, scan.sensing.size(), "points");
        std::vector<int> all(num_bins);
        std::iota(all.begin(), all.end(), 0);
        for (std::size_t pair = 0; pair < scan.num_pairs(); ++pair) {
            const int point = static_cast<int>(scan.sensing_index(pair));
            if (std::ranges::find(settings.mask_points, point) == settings.mask_points.end()) {
                continue;
            }
            masked[pair] = all;
        }
    }
    core::leave_out_bins(masked, capture);
    capture.notes.push_back(fmt::format("{} wall points and {} bins are left out, as told",
                                        settings.mask_points.size(),
                                        settings.mask_bins.size()));
}

}  // namespace

Capture adjust_capture(Capture capture,
                       const CaptureReadSettings& settings,
                       const std::string& where) {
    const bool moves = settings.swap_xy || settings.flip_x || settings.flip_y;
    if (!capture.scan.has_wall() && (moves || settings.wall_size_m || settings.opl_origin)) {
        throw core::Error(where,
                          "is the image of a camera",
                          "must be a scan of a relay wall for capture.wall_size_m, opl_origin, "
                          "swap_xy, flip_x and flip_y");
    }
    if (settings.wall_size_m) set_wall_size(*settings.wall_size_m, capture);
    if (settings.opl_origin) set_origin(*settings.opl_origin, capture);
    if (settings.unit) set_unit(*settings.unit, capture);
    if (moves) move_histograms(settings, where, capture);
    if (settings.flip_t) reverse_time(capture);
    if (settings.opl_shift_m) {
        capture.time_axis.opl_start_m += *settings.opl_shift_m;
        capture.notes.push_back(
            fmt::format("path lengths are moved by {} m, as told", *settings.opl_shift_m));
    }
    if (settings.observed_bins) {
        const auto [begin, end] = *settings.observed_bins;
        core::restrict_observed(capture, core::BinRange{begin, end});
        capture.notes.push_back(
            fmt::format("bins {} to {} count as observed, as told", begin, end - 1));
    }
    if (!settings.mask_points.empty() || !settings.mask_bins.empty()) {
        mask(settings, where, capture);
    }
    return capture;
}

}  // namespace nlos
