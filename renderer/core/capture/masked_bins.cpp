// SPDX-License-Identifier: MIT
#include "renderer/core/capture/masked_bins.h"

#include <algorithm>
#include <cmath>

namespace core {
namespace {

bool is_in(const std::vector<int>& bins, int bin) {
    return std::ranges::binary_search(bins, bin);
}

/// What is left of a range without such bins at its ends.
BinRange without_ends(BinRange range, const std::vector<int>& bins) {
    while (range.size() > 0 && is_in(bins, range.begin)) ++range.begin;
    while (range.size() > 0 && is_in(bins, range.end - 1)) --range.end;
    return range.size() > 0 ? range : BinRange{};
}

/// Fills bins within a range, whose first and last are none of them.
void fill_between(std::span<float> histogram,
                  const BinRange& range,
                  const std::vector<int>& bins,
                  bool is_whole) {
    for (int bin = range.begin; bin < range.end; ++bin) {
        if (!is_in(bins, bin)) continue;
        const int before = bin - 1;
        int behind = bin + 1;
        while (is_in(bins, behind)) ++behind;
        const float from = histogram[static_cast<std::size_t>(before)];
        const float to = histogram[static_cast<std::size_t>(behind)];
        const float value = from + (to - from) / static_cast<float>(behind - before);
        histogram[static_cast<std::size_t>(bin)] = is_whole ? std::round(value) : value;
    }
}

}  // namespace

void leave_out_bins(const MaskedBins& masked, Capture& capture) {
    std::vector<BinRange> ranges;
    for (std::size_t pair = 0; pair < capture.scan.num_pairs(); ++pair) {
        ranges.push_back(capture.observed_range(pair));
    }
    for (const auto& [pair, bins] : masked) ranges[pair] = without_ends(ranges[pair], bins);
    const auto num_bins = static_cast<std::size_t>(capture.time_axis.num_bins);
    const bool is_whole = capture.unit == TransientUnit::Counts;
    for_each_transient(capture, [&](const char*, Transient& transient, int num_axes) {
        for (const auto& [pair, bins] : masked) {
            for (std::size_t axis = 0; axis < static_cast<std::size_t>(num_axes); ++axis) {
                fill_between(transient.histogram(pair).subspan(axis * num_bins, num_bins),
                             ranges[pair],
                             bins,
                             is_whole);
            }
        }
    });
    restrict_observed(capture, ranges);
}

}  // namespace core
