// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace core {

/// Bins [begin, end) of a time axis; none when the two are equal.
struct BinRange {
    int begin = 0;
    int end = 0;

    int size() const { return end - begin; }
    bool holds(int bin) const { return bin >= begin && bin < end; }
    bool operator==(const BinRange&) const = default;
};

/// The bins that two ranges share.
BinRange intersection(const BinRange& a, const BinRange& b);

/// The bins of an axis `merge` times as coarse that lie entirely within a range.
BinRange merged(const BinRange& range, int merge);

/// For each pair of a scan, the bins in which its detector could record: a gate, or no bin for a
/// dead point. Histograms hold 0 in all others, which means that nobody looked, not that it was
/// dark. Nothing: all bins of all pairs were observed.
using ObservedBins = std::optional<std::vector<BinRange>>;

/// The observed bins of one pair on an axis of num_bins.
inline BinRange observed_range(const ObservedBins& observed, std::size_t pair, int num_bins) {
    return observed ? (*observed)[pair] : BinRange{0, num_bins};
}

/// The smallest range with all observed bins of all pairs.
BinRange observed_hull(const ObservedBins& observed, int num_bins);

/// How many bins of all pairs were observed.
std::size_t observed_count(const ObservedBins& observed, std::size_t num_pairs, int num_bins);

/// Makes ranges that leave nothing out the absence of ranges.
void simplify(ObservedBins& observed, int num_bins);

}  // namespace core
