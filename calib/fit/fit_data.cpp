// SPDX-License-Identifier: MIT
#include "calib/fit/fit_data.h"

#include "renderer/core/capture/instrument_response.h"
#include "renderer/core/system/parallel.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace calib {

namespace {

// Bins [first, first + count) of every histogram.
template <class Value>
FitData bins_of(std::span<const Value> values, const core::TimeAxis& axis, int first, int count) {
    FitData part;
    part.axis = axis;
    part.axis.opl_start_m = axis.bin_begin_m(first);
    part.axis.num_bins = count;
    const auto bins = static_cast<std::size_t>(axis.num_bins);
    for (std::size_t at = 0; at < values.size(); at += bins) {
        const auto histogram =
            values.subspan(at + static_cast<std::size_t>(first), static_cast<std::size_t>(count));
        part.values.insert(part.values.end(), histogram.begin(), histogram.end());
    }
    return part;
}

// Observed bins on an axis that begins at `first` and has `count` bins.
core::ObservedBins observed_part(const core::ObservedBins& observed, int first, int count) {
    if (!observed) return std::nullopt;
    std::vector<core::BinRange> part;
    for (const core::BinRange& range : *observed) {
        part.push_back(core::intersection({range.begin - first, range.end - first}, {0, count}));
    }
    return part;
}

// What blurring leaves of an observed range: less at ends beyond which the axis goes on.
core::BinRange unspoilt(const core::BinRange& range, int num_bins, int reach) {
    const core::BinRange left{range.begin > 0 ? range.begin + reach : 0,
                              range.end < num_bins ? range.end - reach : num_bins};
    return range.size() > 0 ? core::intersection(left, {0, num_bins}) : range;
}

struct ObservedSums {
    std::vector<double> sums;
    std::vector<double> counts;
};

// Of the values in equal parts of the axis over all pairs; counts are of the bins observed.
ObservedSums observed_sums(const FitData& data, std::size_t parts) {
    const auto bins = static_cast<std::size_t>(data.axis.num_bins);
    ObservedSums result{std::vector<double>(parts, 0.0), std::vector<double>(parts, 0.0)};
    for (std::size_t pair = 0; pair < data.num_pairs(); ++pair) {
        const core::BinRange seen = data.observed_range(pair);
        for (auto b = static_cast<std::size_t>(seen.begin); b < static_cast<std::size_t>(seen.end);
             ++b) {
            const std::size_t part = b * parts / bins;
            result.sums[part] += data.values[pair * bins + b];
            result.counts[part] += 1.0;
        }
    }
    return result;
}

}  // namespace

FitData crop(const core::Capture& capture, const std::optional<std::array<double, 2>>& window_m) {
    const core::TimeAxis& axis = capture.time_axis;
    int first = 0;
    int last = axis.num_bins;
    if (window_m) {
        const auto bin_at = [&](double opl_m) {
            return std::clamp((opl_m - axis.opl_start_m) / axis.bin_width_m, 0.0, 1.0 * last);
        };
        first = static_cast<int>(std::ceil(bin_at((*window_m)[0])));
        last = static_cast<int>(std::floor(bin_at((*window_m)[1])));
    }
    const core::BinRange seen = core::observed_hull(capture.observed, axis.num_bins);
    if (seen.size() == 0) {
        throw core::Error("capture", "found no observed bin", "must have been observed somewhere");
    }
    first = std::max(first, seen.begin);
    last = std::min(last, seen.end);
    if (first >= last) {
        throw core::Error("window_m",
                          fmt::format("found no bin in [{}, {}]", (*window_m)[0], (*window_m)[1]),
                          fmt::format("the data cover {} to {} m",
                                      axis.bin_begin_m(seen.begin),
                                      axis.bin_begin_m(seen.end)));
    }
    FitData data = bins_of<float>(capture.transient.values(), axis, first, last - first);
    data.observed = observed_part(capture.observed, first, last - first);
    core::simplify(data.observed, data.axis.num_bins);
    return data;
}

FitData coarsen(const FitData& data, double blur_m, int merged) {
    FitData result;
    result.axis = data.axis;
    result.axis.num_bins = data.axis.num_bins / merged;
    result.axis.bin_width_m *= merged;
    const auto bins = static_cast<std::size_t>(data.axis.num_bins);
    const auto target_bins = static_cast<std::size_t>(result.axis.num_bins);
    const std::size_t pairs = data.values.size() / bins;
    if (data.observed) {
        const int reach = static_cast<int>(std::ceil(kBlurReach * blur_m / data.axis.bin_width_m));
        std::vector<core::BinRange>& observed = result.observed.emplace();
        for (const core::BinRange& range : *data.observed) {
            observed.push_back(
                core::intersection(core::merged(unspoilt(range, data.axis.num_bins, reach), merged),
                                   {0, result.axis.num_bins}));
        }
    }
    result.values.assign(pairs * target_bins, 0.0);
    core::ResponseFilter filter{0, {1.0}};
    if (blur_m > 0.0) {
        filter = core::sample_response(core::GaussianResponse{blur_m}, data.axis.bin_width_m);
    }
    core::parallel_for(pairs, [&](std::size_t pair) {
        std::vector<double> smooth(bins);
        core::apply_filter<double, double>(
            filter, std::span(data.values).subspan(pair * bins, bins), smooth);
        for (std::size_t b = 0; b < target_bins * static_cast<std::size_t>(merged); ++b) {
            const std::size_t target = b / static_cast<std::size_t>(merged);
            if (!result.observed_range(pair).holds(static_cast<int>(target))) continue;
            result.values[pair * target_bins + target] += smooth[b];
        }
    });
    return result;
}

FitData trim(const FitData& data, int front, int back) {
    const int left = data.axis.num_bins - front - back;
    FitData result =
        bins_of<double>(data.values, data.axis, left > 0 ? front : 0, std::max(0, left));
    result.axis.opl_start_m = data.axis.bin_begin_m(front);
    result.min_mean = data.min_mean;
    result.observed = observed_part(data.observed, front, result.axis.num_bins);
    return result;
}

std::array<bool, 2> light_is_cut(const FitData& data, double ambient) {
    constexpr std::size_t kEdgeBins = 2;
    constexpr double kFractionOfBrightest = 0.05;
    constexpr double kSignificance = 5.0;
    const auto bins = static_cast<std::size_t>(data.axis.num_bins);
    const ObservedSums all = observed_sums(data, bins);
    const auto light_in = [&](std::size_t b) { return all.sums[b] - ambient * all.counts[b]; };
    double brightest = light_in(0);
    for (std::size_t b = 1; b < bins; ++b) brightest = std::max(brightest, light_in(b));
    const std::size_t width = std::min(kEdgeBins, bins);
    const auto stands_out = [&](std::size_t first) {
        double light = 0.0;
        double counted = 0.0;
        for (std::size_t b = first; b < first + width; ++b) {
            light += light_in(b);
            counted += all.sums[b];
        }
        return light > kFractionOfBrightest * static_cast<double>(width) * brightest &&
               light > kSignificance * std::sqrt(counted);
    };
    return {stands_out(0), stands_out(bins - width)};
}

PairSubset thin(const core::WallScan& scan, std::size_t most) {
    const bool is_exhaustive = scan.pattern == core::ScanPattern::Exhaustive;
    std::size_t step = 1;
    const auto kept = [&](const core::WallPoints& points) {
        std::vector<std::size_t> indices;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const std::size_t columns = points.grid ? (*points.grid)[1] : 1;
            const std::size_t first = step / 2;
            const bool on_grid =
                points.grid ? (i / columns % step == std::min(first, (*points.grid)[0] - 1) &&
                               i % columns % step == std::min(first, columns - 1))
                            : i % (step * step) == 0;
            if (on_grid) indices.push_back(i);
        }
        return indices;
    };
    const auto pick = [](const core::WallPoints& points, const std::vector<std::size_t>& indices) {
        core::WallPoints result;
        for (const std::size_t i : indices) {
            result.positions.push_back(points.positions[i]);
            result.normals.push_back(points.normals[i]);
        }
        return result;
    };
    std::vector<std::size_t> sensing = kept(scan.sensing);
    std::vector<std::size_t> light = kept(scan.illumination);
    const auto count = [&] { return sensing.size() * (is_exhaustive ? light.size() : 1); };
    while (count() > most) {
        ++step;
        sensing = kept(scan.sensing);
        if (is_exhaustive) light = kept(scan.illumination);
    }
    PairSubset subset{scan, {}};
    subset.scan.sensing = pick(scan.sensing, sensing);
    if (scan.pattern == core::ScanPattern::Confocal) subset.scan.illumination = subset.scan.sensing;
    if (is_exhaustive) {
        subset.scan.illumination = pick(scan.illumination, light);
        for (const std::size_t l : light) {
            for (const std::size_t s : sensing) {
                subset.pairs.push_back(l * scan.sensing.size() + s);
            }
        }
    } else {
        subset.pairs = sensing;
    }
    return subset;
}

FitData select(const FitData& data, const std::vector<std::size_t>& pairs) {
    FitData result;
    result.axis = data.axis;
    result.min_mean = data.min_mean;
    const auto bins = static_cast<std::ptrdiff_t>(data.axis.num_bins);
    for (const std::size_t pair : pairs) {
        const auto begin = data.values.begin() + static_cast<std::ptrdiff_t>(pair) * bins;
        result.values.insert(result.values.end(), begin, begin + bins);
    }
    if (!data.observed) return result;
    result.observed.emplace();
    for (const std::size_t pair : pairs) result.observed->push_back((*data.observed)[pair]);
    return result;
}

bool is_integer_valued(const core::Capture& capture) {
    const auto values = capture.transient.values();
    return std::all_of(values.begin(), values.end(), [](float value) {
        return value >= 0.0F && value == std::floor(value);
    });
}

double quietest_level(const FitData& data) {
    constexpr std::size_t kParts = 16;
    const std::size_t parts = std::min(kParts, static_cast<std::size_t>(data.axis.num_bins));
    const auto [sums, counts] = observed_sums(data, parts);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t p = 0; p < parts; ++p) {
        if (counts[p] > 0.0) least = std::min(least, sums[p] / counts[p]);
    }
    return std::max(0.0, least);
}

}  // namespace calib
