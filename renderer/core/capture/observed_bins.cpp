// SPDX-License-Identifier: MIT
#include "renderer/core/capture/observed_bins.h"

#include <algorithm>

namespace core {

BinRange intersection(const BinRange& a, const BinRange& b) {
    const BinRange both{std::max(a.begin, b.begin), std::min(a.end, b.end)};
    return both.size() > 0 ? both : BinRange{};
}

BinRange merged(const BinRange& range, int merge) {
    const BinRange whole{(range.begin + merge - 1) / merge, range.end / merge};
    return whole.size() > 0 ? whole : BinRange{};
}

BinRange observed_hull(const ObservedBins& observed, int num_bins) {
    if (!observed) return {0, num_bins};
    BinRange hull{num_bins, 0};
    for (const BinRange& range : *observed) {
        if (range.size() == 0) continue;
        hull = {std::min(hull.begin, range.begin), std::max(hull.end, range.end)};
    }
    return hull.size() > 0 ? hull : BinRange{};
}

std::size_t observed_count(const ObservedBins& observed, std::size_t num_pairs, int num_bins) {
    if (!observed) return num_pairs * static_cast<std::size_t>(num_bins);
    std::size_t count = 0;
    for (const BinRange& range : *observed) count += static_cast<std::size_t>(range.size());
    return count;
}

void simplify(ObservedBins& observed, int num_bins) {
    if (!observed) return;
    const bool is_all = std::ranges::all_of(*observed, [&](const BinRange& range) {
        return range == BinRange{0, num_bins};
    });
    if (is_all) observed.reset();
}

}  // namespace core
