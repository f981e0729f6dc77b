// SPDX-License-Identifier: MIT
#include "nlos/preparation/histogram_preparation.h"

#include "renderer/core/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace nlos {
namespace {

constexpr std::size_t kSegments = 32;
constexpr std::size_t kDarkSegments = 8;
constexpr double kSignificance = 5.0;    // standard deviations
constexpr double kSmallestShare = 0.01;  // of the strongest segment

using SegmentSums = std::array<double, kSegments>;

/// Equal runs of bins from `begin` on.
struct Segments {
    std::size_t begin = 0;
    std::size_t length = 0;

    double sum(std::span<const float> histogram, std::size_t segment) const {
        const auto first =
            histogram.begin() + static_cast<std::ptrdiff_t>(begin + segment * length);
        return std::accumulate(first, first + static_cast<std::ptrdiff_t>(length), 0.0);
    }
};

/// The first bin that is not zero in every histogram.
std::size_t first_filled_bin(const core::Transient& transient) {
    std::size_t first = transient.num_bins();
    for (std::size_t pair = 0; pair < transient.num_pairs(); ++pair) {
        const auto histogram = transient.histogram(pair);
        const auto end = histogram.begin() + static_cast<std::ptrdiff_t>(first);
        const auto filled =
            std::find_if(histogram.begin(), end, [](float value) { return value != 0.0F; });
        first = static_cast<std::size_t>(filled - histogram.begin());
    }
    return first;
}

SegmentSums sums_over_pairs(const core::Transient& transient, const Segments& segments) {
    SegmentSums sums{};
    for (std::size_t pair = 0; pair < transient.num_pairs(); ++pair) {
        for (std::size_t i = 0; i < kSegments; ++i) {
            sums[i] += segments.sum(transient.histogram(pair), i);
        }
    }
    return sums;
}

}  // namespace

std::optional<SignalExtent> find_signal(const core::Transient& transient) {
    Segments segments;
    segments.begin = first_filled_bin(transient);
    segments.length = (transient.num_bins() - segments.begin) / kSegments;
    if (segments.length < 2) return std::nullopt;
    const SegmentSums sums = sums_over_pairs(transient, segments);

    std::array<std::size_t, kSegments> darkest_first;
    std::iota(darkest_first.begin(), darkest_first.end(), std::size_t{0});
    std::stable_sort(darkest_first.begin(), darkest_first.end(), [&](std::size_t a, std::size_t b) {
        return sums[a] < sums[b];
    });

    SignalExtent extent;
    double ambient_sum = 0.0;
    for (std::size_t pair = 0; pair < transient.num_pairs(); ++pair) {
        double sum = 0.0;
        for (std::size_t i = 0; i < kDarkSegments; ++i) {
            sum += segments.sum(transient.histogram(pair), darkest_first[i]);
        }
        ambient_sum += sum / kDarkSegments;
        extent.ambient_per_bin.push_back(sum /
                                         static_cast<double>(kDarkSegments * segments.length));
    }

    const double strongest = sums[darkest_first.back()] - ambient_sum;
    std::size_t end = 0;
    for (std::size_t i = 0; i < kSegments; ++i) {
        const double excess = sums[i] - ambient_sum;
        if (excess > kSignificance * std::sqrt(sums[i]) && excess > kSmallestShare * strongest) {
            end = i + 1;
        }
    }
    const bool reaches_the_end = end == kSegments || end == 0;
    extent.end_bin = static_cast<int>(reaches_the_end ? transient.num_bins()
                                                      : segments.begin + end * segments.length);
    return extent;
}

core::Transient prepare_histograms(const core::Transient& transient, const PreparationPlan& plan) {
    core::Transient prepared(transient.num_pairs(), plan.num_bins);
    const auto merge = static_cast<std::size_t>(plan.merge_bins);
    core::parallel_for(prepared.num_pairs(), [&](std::size_t pair) {
        const auto input = transient.histogram(pair);
        const auto output = prepared.histogram(pair);
        std::vector<double> signal(input.begin(), input.end());
        const auto first_filled =
            std::find_if(signal.begin(), signal.end(), [](double value) { return value != 0.0; });
        if (!plan.ambient_per_bin.empty()) {
            // Bins zeroed at the start of the axis hold no ambient light either.
            std::for_each(first_filled, signal.end(), [&](double& value) {
                value -= plan.ambient_per_bin[pair];
            });
        }
        if (plan.deconvolution) {
            plan.deconvolution->apply(signal);
            std::fill(signal.begin(), first_filled, 0.0);
        }
        for (std::size_t bin = 0; bin < output.size(); ++bin) {
            const auto first = signal.begin() + static_cast<std::ptrdiff_t>(bin * merge);
            output[bin] = static_cast<float>(
                std::accumulate(first, first + static_cast<std::ptrdiff_t>(merge), 0.0));
        }
    });
    return prepared;
}

void multiply_by_range(const core::Scan& scan,
                       const core::TimeAxis& axis,
                       double power,
                       core::Transient& transient) {
    core::parallel_for(transient.num_pairs(), [&](std::size_t pair) {
        const double legs_m = scan.device_legs_m(pair);
        const auto histogram = transient.histogram(pair);
        for (std::size_t bin = 0; bin < histogram.size(); ++bin) {
            const double opl = axis.bin_center_m(static_cast<double>(bin)) - legs_m;
            histogram[bin] *= static_cast<float>(std::pow(std::max(0.0, 0.5 * opl), power));
        }
    });
}

}  // namespace nlos
