// SPDX-License-Identifier: MIT
#include "nlos/preparation/histogram_sample.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace nlos {
namespace {

constexpr std::size_t kSide = 14;  // pairs along each axis of a grid
constexpr std::size_t kMostPairs = kSide * kSide;
constexpr std::size_t kFewestPairs = 25;  // a few zones can be explained by anything
constexpr std::size_t kMostBins = 48;
constexpr std::size_t kFewestBins = 8;
constexpr double kFirstLight = 0.01;  // fraction of all light before the sample
constexpr double kLastLight = 0.98;
constexpr double kMeanRadiance = 20.0;  // per bin, in place of counts

constexpr double kDirectBins = 1.5;      // to which a direct return is equally late
constexpr double kDirectFraction = 0.9;  // of the pairs
constexpr double kDirectContrast = 5.0;  // against what follows
constexpr double kMostBefore = 0.1;      // of what follows
constexpr double kFaded = 0.03;          // of the direct return's peak

/// `count` of `size` things, evenly spread.
std::size_t spread(std::size_t index, std::size_t count, std::size_t size) {
    return (2 * index + 1) * size / (2 * count);
}

std::vector<std::size_t> some_points(const core::WallPoints& points) {
    std::vector<std::size_t> chosen;
    if (points.grid && std::min((*points.grid)[0], (*points.grid)[1]) > 1) {
        const auto [nx, ny] = *points.grid;
        const std::size_t side_x = std::min(kSide, nx);
        const std::size_t side_y = std::min(kMostPairs / side_x, ny);
        for (std::size_t ix = 0; ix < side_x; ++ix) {
            for (std::size_t iy = 0; iy < side_y; ++iy) {
                chosen.push_back(spread(ix, side_x, nx) * ny + spread(iy, side_y, ny));
            }
        }
        return chosen;
    }
    const std::size_t count = std::min(kMostPairs, points.size());
    for (std::size_t i = 0; i < count; ++i) chosen.push_back(spread(i, count, points.size()));
    return chosen;
}

/// Sums over the sampled pairs of all light up to each bin, above the background.
std::vector<double> light_until(const core::Capture& capture,
                                const std::vector<double>& ambient,
                                const std::vector<std::size_t>& pairs,
                                const std::vector<std::size_t>& first_bins) {
    std::vector<double> sums(capture.transient.num_bins(), 0.0);
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const auto histogram = capture.transient.histogram(pairs[i]);
        for (std::size_t bin = first_bins[i]; bin < sums.size(); ++bin) {
            sums[bin] += static_cast<double>(histogram[bin]) - ambient[pairs[i]];
        }
    }
    std::partial_sum(sums.begin(), sums.end(), sums.begin());
    return sums;
}

/// Chooses the bins that hold nearly all light; false when there are too few.
bool choose_bins(const std::vector<double>& light, HistogramSample& sample) {
    const double total = *std::ranges::max_element(light);
    if (!(total > 0.0)) return false;
    const auto bin_at = [&](double fraction) {
        return static_cast<std::size_t>(
            std::ranges::find_if(light, [&](double sum) { return sum > fraction * total; }) -
            light.begin());
    };
    std::size_t begin = bin_at(kFirstLight);
    if (begin > 0) --begin;
    const std::size_t length = bin_at(kLastLight) + 1 - begin;
    const std::size_t merged = (length + kMostBins - 1) / kMostBins;
    sample.num_bins = std::min((light.size() - begin) / merged, (length + merged - 1) / merged);
    sample.first_bin = static_cast<double>(begin);
    sample.merged_bins = static_cast<double>(merged);
    return sample.num_bins >= kFewestBins;
}

/// Copies the chosen bins of one pair, of which those in `range` were observed.
void append_histogram(std::span<const float> histogram,
                      const core::BinRange& range,
                      HistogramSample& sample) {
    const auto merged = static_cast<std::size_t>(sample.merged_bins);
    for (std::size_t i = 0; i < sample.num_bins; ++i) {
        const std::size_t begin = static_cast<std::size_t>(sample.first_bin) + i * merged;
        const bool is_observed = begin >= static_cast<std::size_t>(range.begin) &&
                                 begin + merged <= static_cast<std::size_t>(range.end);
        const auto bins = histogram.subspan(begin, merged);
        sample.observed.push_back(is_observed ? 1.0F : 0.0F);
        sample.values.push_back(is_observed ? std::accumulate(bins.begin(), bins.end(), 0.0F)
                                            : 0.0F);
    }
}

/// Brings radiance to the size of counts, where single photons matter little.
void scale_radiance(HistogramSample& sample) {
    const double sum = std::accumulate(sample.values.begin(), sample.values.end(), 0.0);
    const auto scale =
        static_cast<float>(kMeanRadiance * static_cast<double>(sample.values.size()) / sum);
    for (float& value : sample.values) value *= scale;
    for (float& value : sample.ambient) value *= scale;
}

double shortest_m(const core::WallScan& scan, std::size_t pair) {
    return scan.device_segments_m(pair) +
           (scan.illumination_point(pair) - scan.sensing_point(pair)).norm();
}

/// Light of a histogram without its peak, which reaches from as far before it as it fades behind.
struct OtherLight {
    double before = 0.0;
    double after = 0.0;
    double brightest_after = 0.0;
};

OtherLight light_beside(const std::span<const float>& histogram,
                        std::size_t peak,
                        std::size_t end,
                        double ambient) {
    OtherLight other;
    for (std::size_t bin = 0; bin < histogram.size(); ++bin) {
        const double light = static_cast<double>(histogram[bin]) - ambient;
        if (bin < 2 * peak - std::min(2 * peak, end)) other.before += light;
        if (bin < end) continue;
        other.after += light;
        other.brightest_after = std::max(other.brightest_after, light);
    }
    return other;
}

/// The first bin behind `peak` where a histogram has fallen to a small fraction of it.
std::size_t fading_end(const std::span<const float>& histogram, std::size_t peak, double ambient) {
    const double faded = kFaded * (static_cast<double>(histogram[peak]) - ambient);
    std::size_t end = peak + 1;
    while (end < histogram.size() && static_cast<double>(histogram[end]) - ambient > faded) ++end;
    return end;
}

}  // namespace

std::vector<std::size_t> sampled_pairs(const core::WallScan& scan) {
    const std::vector<std::size_t> sensed = some_points(scan.sensing);
    if (scan.pattern != core::ScanPattern::Exhaustive) return sensed;
    const std::vector<std::size_t> lit = some_points(scan.illumination);
    constexpr std::size_t kStride = 37;  // neighbours in one list are far apart in the other
    std::vector<std::size_t> pairs;
    for (std::size_t i = 0; i < std::min(kMostPairs, sensed.size() * lit.size()); ++i) {
        const std::size_t s = i % sensed.size();
        const std::size_t l = (i / sensed.size() + kStride * s) % lit.size();
        pairs.push_back(lit[l] * scan.sensing.size() + sensed[s]);
    }
    return pairs;
}

std::optional<DirectReturn> find_direct_return(const core::Capture& capture,
                                               const std::vector<double>& ambient) {
    const std::vector<std::size_t> pairs = sampled_pairs(capture.scan.wall());
    std::vector<double> late_m;
    std::vector<double> fading_m;
    DirectReturn found;
    std::size_t standing_out = 0;
    double before = 0.0;
    double after = 0.0;
    for (const std::size_t pair : pairs) {
        const auto histogram = capture.transient.histogram(pair);
        const auto peak = static_cast<std::size_t>(
            std::max_element(histogram.begin(), histogram.end()) - histogram.begin());
        const std::size_t end = fading_end(histogram, peak, ambient[pair]);
        const OtherLight other = light_beside(histogram, peak, end, ambient[pair]);
        before += other.before;
        after += other.after;
        const double top = static_cast<double>(histogram[peak]) - ambient[pair];
        standing_out += top > kDirectContrast * other.brightest_after ? 1 : 0;
        found.end_bins.push_back(end);
        fading_m.push_back(capture.time_axis.bin_width_m * static_cast<double>(end - peak));
        late_m.push_back(capture.time_axis.bin_center_m(static_cast<double>(peak)) -
                         shortest_m(capture.scan.wall(), pair));
    }
    const auto count = static_cast<double>(pairs.size());
    if (static_cast<double>(standing_out) < kDirectFraction * count) return std::nullopt;
    if (!(after > 0.0) || before > kMostBefore * after) return std::nullopt;
    std::ranges::sort(late_m);
    std::ranges::sort(fading_m);
    found.offset_m = late_m[late_m.size() / 2];
    found.fading_m = fading_m[fading_m.size() / 2];
    const auto equally_late = std::ranges::count_if(late_m, [&](double late) {
        return std::abs(late - found.offset_m) < kDirectBins * capture.time_axis.bin_width_m;
    });
    if (static_cast<double>(equally_late) < kDirectFraction * count) return std::nullopt;
    return found;
}

std::optional<HistogramSample> sample_histograms(const core::Capture& capture,
                                                 const std::vector<double>& ambient,
                                                 const std::optional<DirectReturn>& direct) {
    HistogramSample sample;
    sample.pairs = sampled_pairs(capture.scan.wall());
    if (sample.pairs.size() < kFewestPairs) return std::nullopt;
    const std::vector<std::size_t> first_bins =
        direct ? direct->end_bins : std::vector<std::size_t>(sample.pairs.size(), 0);
    if (!choose_bins(light_until(capture, ambient, sample.pairs, first_bins), sample)) {
        return std::nullopt;
    }
    for (std::size_t i = 0; i < sample.pairs.size(); ++i) {
        const std::size_t pair = sample.pairs[i];
        core::BinRange range = capture.observed_range(pair);
        range.begin = std::max(range.begin, static_cast<int>(first_bins[i]));
        append_histogram(capture.transient.histogram(pair), range, sample);
        sample.ambient.push_back(static_cast<float>(ambient[pair] * sample.merged_bins));
    }
    sample.has_poisson_noise = capture.unit == core::TransientUnit::Counts;
    if (!sample.has_poisson_noise) scale_radiance(sample);
    return sample;
}

}  // namespace nlos
