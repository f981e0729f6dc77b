// SPDX-License-Identifier: MIT
#include "nlos/preparation/direct_response.h"

#include "nlos/preparation/histogram_preparation.h"
#include "nlos/preparation/histogram_sample.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace nlos {
namespace {

constexpr double kTimeZeroPs = 200.0;  // within which the peak must lie
constexpr double kTimeZeroBins = 2.0;  // likewise
constexpr double kEnd = 1e-3;          // of the peak
constexpr double kShortestBins = 0.5;  // deviation of a response that is worth reporting

/// Histograms moved by their device segments to whole bins and added up.
class AlignedSum {
 public:
    AlignedSum(const core::Capture& capture, const std::vector<double>& ambient)
        : bin_width_m_(capture.time_axis.bin_width_m) {
        const auto [shortest, longest] = core::device_segment_range_m(capture.scan.wall());
        start_m_ = capture.time_axis.opl_start_m - longest;
        has_shifts_ = longest - shortest > 1e-3 * bin_width_m_;
        const auto num_bins = static_cast<std::size_t>(capture.time_axis.num_bins);
        sum.assign(num_bins + bins(longest - shortest), 0.0);
        for (std::size_t pair = 0; pair < capture.scan.num_pairs(); ++pair) {
            const std::size_t shift = bins(longest - capture.scan.wall().device_segments_m(pair));
            const auto histogram = capture.transient.histogram(pair);
            for (std::size_t i = 0; i < num_bins; ++i) {
                sum[shift + i] += static_cast<double>(histogram[i]) - ambient[pair];
            }
        }
    }

    /// Path length of a bin's centre, from and to the wall.
    double center_m(std::size_t bin) const {
        return start_m_ + (static_cast<double>(bin) + 0.5) * bin_width_m_;
    }
    /// What bins and whole shifts add to a variance.
    double own_variance_m2() const {
        return (has_shifts_ ? 2.0 : 1.0) * bin_width_m_ * bin_width_m_ / 12.0;
    }

    std::vector<double> sum;

 private:
    std::size_t bins(double distance_m) const {
        return static_cast<std::size_t>(std::lround(distance_m / bin_width_m_));
    }

    double start_m_ = 0.0, bin_width_m_;
    bool has_shifts_ = false;
};

/// Bins [begin, end) of a peak.
struct PeakBins {
    std::size_t begin, end;
};

/// The peak around a bin of a sum without background; nothing when it is cut off by the axis.
std::optional<PeakBins> peak_bins(const std::vector<double>& sum, std::size_t peak) {
    const double least = kEnd * sum[peak];
    const auto falls = [&](std::size_t from, std::size_t to) {
        return sum[to] > least && (sum[to] < sum[from] || sum[to] > 0.1 * sum[peak]);
    };
    PeakBins bins{peak, peak + 1};
    while (bins.begin > 0 && falls(bins.begin, bins.begin - 1)) --bins.begin;
    while (bins.end < sum.size() && falls(bins.end - 1, bins.end)) ++bins.end;
    if (bins.begin == 0 || bins.end == sum.size()) return std::nullopt;
    return bins;
}

core::ResponseSettings response_of(const AlignedSum& aligned,
                                   const PeakBins& bins,
                                   double bin_width_m) {
    double total = 0.0;
    double mean = 0.0;
    for (std::size_t i = bins.begin; i < bins.end; ++i) {
        total += aligned.sum[i];
        mean += aligned.sum[i] * aligned.center_m(i);
    }
    mean /= total;
    double variance = 0.0;
    double third = 0.0;
    for (std::size_t i = bins.begin; i < bins.end; ++i) {
        const double d = aligned.center_m(i) - mean;
        variance += aligned.sum[i] / total * d * d;
        third += aligned.sum[i] / total * d * d * d;
    }
    variance = std::max(0.0, variance - aligned.own_variance_m2());
    core::ResponseSettings response;
    if (std::sqrt(variance) < kShortestBins * bin_width_m) return response;
    const double tail_m = std::min(std::cbrt(std::max(0.0, 0.5 * third)), std::sqrt(variance));
    const double sigma_m = std::sqrt(std::max(0.0, variance - tail_m * tail_m));
    const auto rounded = [](double ps) { return 0.1 * std::round(10.0 * ps); };
    response.jitter_fwhm_ps = rounded(sigma_m / core::sigma_m_from_fwhm_ps(1.0));
    response.tail_ps = rounded(1e12 * tail_m / core::kSpeedOfLight);
    return response;
}

}  // namespace

std::optional<DirectResponse> measure_direct_return(const core::Capture& capture) {
    if (capture.scan.wall().pattern != core::ScanPattern::Confocal) return std::nullopt;
    const std::optional<SignalExtent> signal = find_signal(capture.transient, capture.observed);
    const std::vector<double> ambient =
        signal ? signal->ambient_per_bin : std::vector<double>(capture.scan.num_pairs(), 0.0);
    const std::optional<DirectReturn> direct = find_direct_return(capture, ambient);
    const double bin_width_m = capture.time_axis.bin_width_m;
    const double reach_m =
        std::max(kTimeZeroBins * bin_width_m, core::opl_from_seconds(1e-12 * kTimeZeroPs));
    if (!direct || std::abs(direct->offset_m) > reach_m) return std::nullopt;
    const AlignedSum aligned(capture, ambient);
    const auto peak =
        static_cast<std::size_t>(std::ranges::max_element(aligned.sum) - aligned.sum.begin());
    const std::optional<PeakBins> bins = peak_bins(aligned.sum, peak);
    if (!bins) return std::nullopt;
    const double end_m = aligned.center_m(bins->end) - 0.5 * bin_width_m;
    return DirectResponse{response_of(aligned, *bins, bin_width_m),
                          end_m + core::device_segment_range_m(capture.scan.wall())[1]};
}

std::string describe(const DirectResponse& direct) {
    return fmt::format("the wall's direct return up to {:.4g} m of path length, left out; {}",
                       direct.end_opl_m,
                       core::is_given(direct.response) ? "its shape is taken as the response"
                                                       : "it is no wider than a bin");
}

}  // namespace nlos
