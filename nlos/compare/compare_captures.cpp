// SPDX-License-Identifier: MIT
#include "nlos/compare/compare.h"
#include "nlos/compare/compare_image.h"
#include "renderer/core/nearest_neighbours.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace nlos {
namespace {

std::string points_text(const core::WallPoints& points) {
    if (!points.grid) return fmt::format("{} points", points.size());
    return fmt::format("{} x {} points", (*points.grid)[0], (*points.grid)[1]);
}

/// Pattern, points and bins: what tells scans apart.
std::string scan_text(const core::Capture& capture) {
    const std::string bins = fmt::format("{} bins", capture.transient.num_bins());
    return capture.scan.visit(
        [&](const core::WallScan& scan) {
            const std::string lit =
                scan.is_confocal() ? ""
                                   : fmt::format(" lit from {}", points_text(scan.illumination));
            return fmt::format("a {} scan of {}{} and {}",
                               core::enum_name(scan.pattern),
                               points_text(scan.sensing),
                               lit,
                               bins);
        },
        [&](const core::ImageScan& image) {
            const auto pixels = image.pair_extents();
            return fmt::format("an image of {} x {} pixels and {}", pixels[0], pixels[1], bins);
        });
}

void check_same_shape(const core::Capture& found, const core::Capture& wanted) {
    if (found.transient.num_pairs() == wanted.transient.num_pairs() &&
        found.transient.num_bins() == wanted.transient.num_bins()) {
        return;
    }
    throw core::Error("compare: H",
                      fmt::format("found {} against {}", scan_text(found), scan_text(wanted)),
                      "both captures must have the same shape");
}

void check_same_unit(core::TransientUnit found, core::TransientUnit wanted) {
    if (found == wanted) return;
    throw core::Error(
        "compare: unit",
        fmt::format("found {} against {}", core::enum_name(found), core::enum_name(wanted)),
        "both captures must have the same unit");
}

/// Throws when a bin lies more than a hundredth of its width beside its counterpart.
void check_same_bins(const core::TimeAxis& found, const core::TimeAxis& wanted) {
    const double start_gap_m = std::abs(found.opl_start_m - wanted.opl_start_m);
    const double end_gap_m = std::abs(found.opl_end_m() - wanted.opl_end_m());
    if (std::max(start_gap_m, end_gap_m) <= 0.01 * wanted.bin_width_m) return;
    throw core::Error("compare: time axis",
                      fmt::format("found {} m to {} m against {} m to {} m",
                                  found.opl_start_m,
                                  found.opl_end_m(),
                                  wanted.opl_start_m,
                                  wanted.opl_end_m()),
                      "both captures must have the same bins");
}

/// Which of the points are the wanted ones; as they stand unless all of them are there, reordered.
std::vector<std::size_t> counterparts(const std::vector<core::Vec3>& wanted,
                                      const std::vector<core::Vec3>& points) {
    constexpr double kRounding_m = 1e-5;  // files hold points in single precision
    std::vector<std::size_t> indices(wanted.size());
    std::iota(indices.begin(), indices.end(), std::size_t{0});
    const auto agree = [&](std::size_t i) { return (wanted[i] - points[i]).norm() <= kRounding_m; };
    if (wanted.size() != points.size() || std::ranges::all_of(indices, agree)) return indices;
    const core::NearestNeighbours nearest = core::nearest_neighbours(wanted, points);
    const bool all_are_there = *std::ranges::max_element(nearest.distances_m) <= kRounding_m;
    return all_are_there ? nearest.indices : indices;
}

/// The result's pair for each of the reference's: formats run through the wall's points in
/// different directions.
std::vector<std::size_t> matching_pairs(const core::Capture& reference,
                                        const core::Capture& result) {
    std::vector<std::size_t> pairs(reference.scan.num_pairs());
    std::iota(pairs.begin(), pairs.end(), std::size_t{0});
    if (!reference.scan.has_wall() || !result.scan.has_wall()) return pairs;
    const core::WallScan& scan = reference.scan.wall();
    const core::WallScan& found = result.scan.wall();
    if (scan.pattern != found.pattern) return pairs;
    const auto sensing = counterparts(scan.sensing.positions, found.sensing.positions);
    const auto lit = counterparts(scan.illumination.positions, found.illumination.positions);
    for (std::size_t& pair : pairs) {
        std::size_t from = sensing[scan.sensing_index(pair)];
        if (scan.is_exhaustive()) {
            from += lit[scan.illumination_index(pair)] * sensing.size();
        }
        pair = from;
    }
    return pairs;
}

/// A histogram whose bins outside a range count as 0.
void keep(const core::BinRange& range, std::span<float> histogram) {
    std::fill(histogram.begin(), histogram.begin() + range.begin, 0.0F);
    std::fill(histogram.begin() + range.end, histogram.end(), 0.0F);
}

}  // namespace

Metrics compare_captures(const core::Capture& result, const core::Capture& reference) {
    check_same_shape(result, reference);
    check_same_unit(result.unit, reference.unit);
    check_same_bins(result.time_axis, reference.time_axis);
    Metrics metrics;
    const std::vector<std::size_t> pairs = matching_pairs(reference, result);
    core::Transient found = result.transient;
    core::Transient wanted = reference.transient;
    for (std::size_t pair = 0; pair < pairs.size(); ++pair) {
        std::ranges::copy(result.transient.histogram(pairs[pair]), found.histogram(pair).begin());
        const core::BinRange both =
            core::intersection(result.observed_range(pairs[pair]), reference.observed_range(pair));
        keep(both, found.histogram(pair));
        keep(both, wanted.histogram(pair));
    }
    metrics.rel_mse = relative_mse(found.values(), wanted.values());
    if (metrics.rel_mse) metrics.rel_l2 = std::sqrt(*metrics.rel_mse);
    return metrics;
}

std::vector<std::string> comparison_warnings(const core::Capture& result,
                                             const core::Capture& reference) {
    constexpr double kTolerance_m = 1e-4;
    std::vector<std::string> warnings;
    const core::Scan& a = result.scan;
    const core::Scan& b = reference.scan;
    const auto compare = [&](const char* name,
                             const std::vector<core::Vec3>& points,
                             const std::vector<core::Vec3>& wanted) {
        if (points.size() != wanted.size()) {
            warnings.push_back(fmt::format(
                "the scans differ: {} {} points against {}", points.size(), name, wanted.size()));
            return;
        }
        const std::vector<std::size_t> order = counterparts(wanted, points);
        double largest_m = 0.0;
        for (std::size_t i = 0; i < wanted.size(); ++i) {
            largest_m = std::max(largest_m, (points[order[i]] - wanted[i]).norm());
        }
        if (largest_m <= kTolerance_m) return;
        warnings.push_back(
            fmt::format("the scans differ: {} points lie up to {:.3g} m from those they are "
                        "compared with",
                        name,
                        largest_m));
    };
    if (a.has_wall() != b.has_wall()) {
        warnings.emplace_back("one is the image of a camera, the other a scan");
    } else if (a.pattern() != b.pattern()) {
        warnings.push_back(fmt::format("the scans differ: {} against {}",
                                       core::enum_name(a.pattern()),
                                       core::enum_name(b.pattern())));
    } else if (a.has_wall()) {
        compare("sensing", a.wall().sensing.positions, b.wall().sensing.positions);
        compare("illumination", a.wall().illumination.positions, b.wall().illumination.positions);
    }
    if (a.opl_origin() != b.opl_origin()) {
        warnings.push_back(
            fmt::format("path lengths begin at the {} in one and the {} in the other",
                        core::enum_name(a.opl_origin()),
                        core::enum_name(b.opl_origin())));
    }
    if (result.observed || reference.observed) {
        warnings.emplace_back("bins that one of the two did not observe do not count");
    }
    if (result.transient.is_dark()) warnings.emplace_back("the result holds no light");
    if (reference.transient.is_dark()) warnings.emplace_back("the reference holds no light");
    return warnings;
}

}  // namespace nlos
