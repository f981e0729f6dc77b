// SPDX-License-Identifier: MIT
#include "nlos/preparation/histogram_preparation.h"

#include "renderer/core/system/parallel.h"
#include "renderer/core/types.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace nlos {
namespace {

constexpr std::size_t kSegments = 32;
constexpr std::size_t kSegmentsPerDark = 4;  // one in so many segments is taken for dark
constexpr double kSignificance = 5.0;        // standard deviations
constexpr double kSmallestFraction = 0.01;   // of the strongest segment
constexpr double kConstant = 0.1;            // of a background: by which its segments may differ

/// Light, its squares and the number of bins that it was observed in.
struct SeenLight {
    double sum = 0.0;
    double squares = 0.0;
    double bins = 0.0;

    SeenLight& operator+=(const SeenLight& other) {
        sum += other.sum;
        squares += other.squares;
        bins += other.bins;
        return *this;
    }
};

using SegmentLight = std::array<SeenLight, kSegments>;

/// Equal runs of bins from `begin` on.
struct Segments {
    int begin = 0;
    int length = 0;

    SeenLight light(std::span<const float> histogram,
                    const core::BinRange& observed,
                    std::size_t segment) const {
        const int first = begin + static_cast<int>(segment) * length;
        const core::BinRange seen = core::intersection(observed, {first, first + length});
        const auto from = histogram.begin() + seen.begin;
        const auto end = from + seen.size();
        return {std::accumulate(from, end, 0.0),
                std::inner_product(from, end, from, 0.0),
                1.0 * seen.size()};
    }
};

/// The bins from the first to the last that any histogram holds something in; none in the dark.
core::BinRange filled_bins(const core::Transient& transient) {
    const auto is_filled = [](float value) { return value != 0.0F; };
    std::size_t begin = transient.num_bins();
    std::size_t end = 0;
    for (std::size_t pair = 0; pair < transient.num_pairs(); ++pair) {
        const auto histogram = transient.histogram(pair);
        const auto before = histogram.first(begin);
        begin = static_cast<std::size_t>(std::ranges::find_if(before, is_filled) - before.begin());
        const auto behind = histogram.subspan(end);
        end += static_cast<std::size_t>(
            std::find_if(behind.rbegin(), behind.rend(), is_filled).base() - behind.begin());
    }
    return begin < end ? core::BinRange{static_cast<int>(begin), static_cast<int>(end)}
                       : core::BinRange{};
}

/// Whether a background goes on to the last filled bin and then is none: what is behind was never
/// recorded. Light fades instead, and what is behind it is dark.
bool ends_at_once(const core::Transient& transient, const core::BinRange& filled) {
    constexpr int kEdge = 2;
    constexpr double kLevel = 0.5;  // of the last segment's
    constexpr double kCounts = kSignificance * kSignificance;
    const int segment = std::max(kEdge, filled.size() / static_cast<int>(kSegments));
    const std::vector<double> light = light_per_bin(transient, nullptr, {});
    const auto mean_of_last = [&](int count) {
        return std::accumulate(
                   light.begin() + filled.end - count, light.begin() + filled.end, 0.0) /
               count;
    };
    return filled.size() > segment && kEdge * mean_of_last(kEdge) > kCounts &&
           mean_of_last(kEdge) > kLevel * mean_of_last(segment);
}

Segments make_segments(const core::Transient& transient, const core::ObservedBins& observed) {
    core::BinRange range = core::observed_hull(observed, static_cast<int>(transient.num_bins()));
    if (!observed) {
        const core::BinRange filled = filled_bins(transient);
        range.begin = filled.size() > 0 ? filled.begin : range.end;
        if (filled.end < range.end && ends_at_once(transient, filled)) range.end = filled.end;
    }
    return {range.begin, range.size() / static_cast<int>(kSegments)};
}

/// Histograms in segments, a part of the bins observed.
class SegmentedTransient {
 public:
    SegmentedTransient(const core::Transient& transient,
                       const core::ObservedBins& observed,
                       const Segments& segments,
                       core::TransientUnit unit)
        : transient_(transient), observed_(observed), segments_(segments) {
        for (std::size_t pair = 0; pair < transient.num_pairs(); ++pair) {
            for (std::size_t i = 0; i < kSegments; ++i) total_[i] += light(pair, i);
        }
        std::iota(darkest_first_.begin(), darkest_first_.end(), std::size_t{0});
        std::ranges::stable_sort(darkest_first_, {}, [&](std::size_t i) {
            return is_seen(i) ? sum(i) : std::numeric_limits<double>::infinity();
        });
        if (unit != core::TransientUnit::Counts) variance_per_light_ = dark_variance_per_light();
    }

    std::size_t num_seen() const {
        return static_cast<std::size_t>(
            std::ranges::count_if(total_, [](const SeenLight& light) { return light.bins > 0.0; }));
    }
    bool is_seen(std::size_t i) const { return total_[i].bins > 0.0; }

    /// Variance of values over their mean where it is dark.
    double variance_per_light() const { return variance_per_light_; }

    /// Light of all pairs, had all of them observed the segment, and its standard deviation.
    double sum(std::size_t i) const { return total_[i].sum * full_sight(i); }
    double deviation(std::size_t i) const {
        return std::sqrt(variance_per_light_ * std::max(0.0, total_[i].sum)) * full_sight(i);
    }
    double strongest() const { return sum(darkest_first_[num_seen() - 1]); }

    /// Light of one pair in the darkest segments.
    SeenLight dark_light(std::size_t pair) const {
        SeenLight dark;
        for (std::size_t i = 0; i < num_dark(); ++i) dark += light(pair, darkest_first_[i]);
        return dark;
    }
    std::size_t num_dark() const { return std::max<std::size_t>(1, num_seen() / kSegmentsPerDark); }

    /// Whether the darkest segments hold as much as each other, not nothing, and less than others.
    bool is_dark_constant() const {
        const std::size_t brightest = darkest_first_[num_dark() - 1];
        const double least = sum(darkest_first_[0]);
        const double tolerance = kConstant * sum(brightest) + kSignificance * deviation(brightest);
        return least > 0.0 && sum(brightest) - least < tolerance &&
               strongest() - sum(brightest) > tolerance;
    }

 private:
    /// Variance of values in the darkest segments over their mean: 1 of counts, less of means.
    double dark_variance_per_light() const {
        double squares = 0.0;
        double degrees = 0.0;
        double sum = 0.0;
        double bins = 0.0;
        for (std::size_t pair = 0; pair < transient_.num_pairs(); ++pair) {
            const SeenLight dark = dark_light(pair);
            if (dark.bins < 2.0) continue;
            squares += dark.squares - dark.sum * dark.sum / dark.bins;
            degrees += dark.bins - 1.0;
            sum += dark.sum;
            bins += dark.bins;
        }
        return sum > 0.0 ? std::max(0.0, squares / degrees) / (sum / bins) : 0.0;
    }

    SeenLight light(std::size_t pair, std::size_t segment) const {
        const int num_bins = static_cast<int>(transient_.num_bins());
        return segments_.light(
            transient_.histogram(pair), core::observed_range(observed_, pair, num_bins), segment);
    }
    double full_sight(std::size_t i) const {
        return static_cast<double>(transient_.num_pairs()) * segments_.length / total_[i].bins;
    }

    const core::Transient& transient_;
    const core::ObservedBins& observed_;
    const Segments& segments_;
    SegmentLight total_{};
    std::array<std::size_t, kSegments> darkest_first_{};
    double variance_per_light_ = 1.0;
};

/// The bins of a histogram that were recorded: those observed, or those from the first that is not
/// 0 on.
core::BinRange recorded_bins(std::span<const float> histogram,
                             const PreparationPlan& plan,
                             std::size_t pair) {
    if (plan.observed) return (*plan.observed)[pair];
    const auto first = std::ranges::find_if(histogram, [](float value) { return value != 0.0F; });
    return {static_cast<int>(first - histogram.begin()), static_cast<int>(histogram.size())};
}

/// Rises from 0 to 1 over `length` bins.
double raised_cosine(int bin, int length) {
    return 0.5 - 0.5 * std::cos(core::kPi * (bin + 0.5) / length);
}

}  // namespace

std::optional<SignalExtent> find_signal(const core::Transient& transient,
                                        const core::ObservedBins& observed,
                                        core::TransientUnit unit) {
    const Segments segments = make_segments(transient, observed);
    if (segments.length < 2) return std::nullopt;
    const SegmentedTransient parts(transient, observed, segments, unit);

    std::vector<SeenLight> dark;
    SeenLight all_dark;
    for (std::size_t pair = 0; pair < transient.num_pairs(); ++pair) {
        all_dark += dark.emplace_back(parts.dark_light(pair));
    }
    SignalExtent extent;
    extent.has_background = parts.is_dark_constant();
    extent.photon = parts.variance_per_light();
    double ambient_sum = 0.0;
    for (const SeenLight& own : dark) {
        const SeenLight& light = own.bins < segments.length ? all_dark : own;
        extent.ambient_per_bin.push_back(light.sum / light.bins);
        const double dark_bins = static_cast<double>(parts.num_dark()) * segments.length;
        ambient_sum += light.sum * (dark_bins / light.bins) / static_cast<double>(parts.num_dark());
    }

    const double strongest = parts.strongest() - ambient_sum;
    int end = 0;
    for (std::size_t i = 0; i < kSegments; ++i) {
        if (!parts.is_seen(i)) continue;
        const double excess = parts.sum(i) - ambient_sum;
        if (excess > kSignificance * parts.deviation(i) && excess > kSmallestFraction * strongest) {
            end = static_cast<int>(i) + 1;
        }
    }
    extent.begin_bin = segments.begin;
    extent.reaches_the_end = end == static_cast<int>(kSegments);
    extent.end_bin = extent.reaches_the_end || end == 0 ? static_cast<int>(transient.num_bins())
                                                        : segments.begin + end * segments.length;
    return extent;
}

std::vector<double> light_per_bin(const core::Transient& transient,
                                  const std::vector<core::BinRange>* observed,
                                  const std::vector<double>& background) {
    const int num_bins = static_cast<int>(transient.num_bins());
    std::vector<double> light(transient.num_bins(), 0.0);
    for (std::size_t pair = 0; pair < transient.num_pairs(); ++pair) {
        const core::BinRange seen = observed ? (*observed)[pair] : core::BinRange{0, num_bins};
        const double own_background = background.empty() ? 0.0 : background[pair];
        const auto histogram = transient.histogram(pair);
        for (auto bin = static_cast<std::size_t>(seen.begin);
             bin < static_cast<std::size_t>(seen.end);
             ++bin) {
            light[bin] += static_cast<double>(histogram[bin]) - own_background;
        }
    }
    return light;
}

core::ObservedBins prepared_observed(const PreparationPlan& plan) {
    if (!plan.observed) return std::nullopt;
    std::vector<core::BinRange> ranges;
    for (std::size_t pair = 0; pair < plan.observed->size(); ++pair) {
        ranges.push_back(plan.prepared_range(pair));
    }
    return ranges;
}

std::vector<double> signal_of(const core::Transient& transient,
                              const PreparationPlan& plan,
                              std::size_t pair) {
    const auto input = transient.histogram(pair);
    std::vector<double> signal(input.begin(), input.end());
    const core::BinRange recorded = recorded_bins(input, plan, pair);
    const auto first = signal.begin() + recorded.begin;
    const auto end = signal.begin() + recorded.end;
    if (!plan.ambient_per_bin.empty()) {
        // Bins zeroed at the start of the axis hold no ambient light either.
        std::for_each(first, end, [&](double& value) { value -= plan.ambient_per_bin[pair]; });
    }
    const int begin = plan.observed ? recorded.begin : plan.taper.begin_bin;
    for (int bin = begin; bin < std::min(begin + plan.taper.opening_bins, recorded.end); ++bin) {
        signal[static_cast<std::size_t>(bin)] *=
            raised_cosine(bin - begin, plan.taper.opening_bins);
    }
    for (int i = 0; i < std::min(plan.taper.end_bins, recorded.size()); ++i) {
        signal[static_cast<std::size_t>(recorded.end - 1 - i)] *=
            raised_cosine(i, plan.taper.end_bins);
    }
    return signal;
}

core::Transient prepare_histograms(const core::Transient& transient, const PreparationPlan& plan) {
    core::Transient prepared(transient.num_pairs(), plan.num_bins);
    const int merge = plan.merge_bins;
    core::parallel_for(prepared.num_pairs(), [&](std::size_t pair) {
        const auto output = prepared.histogram(pair);
        std::vector<double> signal = signal_of(transient, plan, pair);
        if (plan.deconvolution) {
            const core::BinRange recorded = recorded_bins(transient.histogram(pair), plan, pair);
            plan.deconvolution->apply(signal);
            std::fill(signal.begin(), signal.begin() + recorded.begin, 0.0);
            std::fill(signal.begin() + recorded.end, signal.end(), 0.0);
        }
        const core::BinRange range = plan.prepared_range(pair);
        for (int bin = range.begin; bin < range.end; ++bin) {
            const auto from = signal.begin() + bin * merge;
            output[static_cast<std::size_t>(bin)] =
                static_cast<float>(std::accumulate(from, from + merge, 0.0));
        }
    });
    return prepared;
}

void multiply_by_range(const core::WallScan& scan,
                       const core::TimeAxis& axis,
                       double power,
                       core::Transient& transient) {
    core::parallel_for(transient.num_pairs(), [&](std::size_t pair) {
        const double segments_m = scan.device_segments_m(pair);
        const auto histogram = transient.histogram(pair);
        for (std::size_t bin = 0; bin < histogram.size(); ++bin) {
            const double opl = axis.bin_center_m(static_cast<double>(bin)) - segments_m;
            histogram[bin] *= static_cast<float>(std::pow(std::max(0.0, 0.5 * opl), power));
        }
    });
}

}  // namespace nlos
