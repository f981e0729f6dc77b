// SPDX-License-Identifier: MIT
#include "apps/python/capture_histograms.h"

#include "renderer/core/system/parallel.h"

#include <limits>

namespace python {
namespace {

namespace nb = nanobind;

/// Whether histograms lie in memory as core::Transient keeps them: [pair][bin].
bool has_bins_fastest(const HistogramArray& array) {
    std::int64_t stride = 1;
    if (array.shape(0) > 1 && array.stride(0) != stride) return false;
    stride = static_cast<std::int64_t>(array.shape(0));
    for (std::size_t axis = array.ndim() - 1; axis >= 1; --axis) {
        if (array.shape(axis) > 1 && array.stride(axis) != stride) return false;
        stride *= static_cast<std::int64_t>(array.shape(axis));
    }
    return true;
}

core::Transient borrowed(const HistogramArray& array, std::size_t num_pairs) {
    const std::shared_ptr<void> owner(new HistogramArray(array), [](void* p) {
        const nb::gil_scoped_acquire acquired;
        delete static_cast<HistogramArray*>(p);
    });
    return {num_pairs, {array.data(), array.size()}, owner};
}

/// Offset of every pair's first bin in an array [elements].
std::vector<std::int64_t> pair_offsets(const HistogramArray& array) {
    std::vector<std::int64_t> offsets{0};
    for (std::size_t axis = 1; axis < array.ndim(); ++axis) {
        std::vector<std::int64_t> finer;
        finer.reserve(offsets.size() * array.shape(axis));
        for (const std::int64_t offset : offsets) {
            for (std::size_t i = 0; i < array.shape(axis); ++i) {
                finer.push_back(offset + static_cast<std::int64_t>(i) * array.stride(axis));
            }
        }
        offsets = std::move(finer);
    }
    return offsets;
}

}  // namespace

Extents histogram_shape(const core::Scan& scan, std::size_t num_bins) {
    Extents shape{num_bins};
    for (const std::size_t extent : scan.pair_extents()) shape.push_back(extent);
    return shape;
}

HistogramArray histograms_from(nb::handle value, const std::string& name) {
    nb::object array = numbers_from(value, "float32", name);
    if (!nb::cast<bool>(array.attr("flags").attr("writeable"))) array = array.attr("copy")();
    return nb::cast<HistogramArray>(array);
}

core::Transient transient_from(const HistogramArray& array) {
    if (array.ndim() < 2 || array.size() == 0) {
        throw core::Error("H",
                          "has " + std::to_string(array.ndim()) + " axes and " +
                              std::to_string(array.size()) + " values",
                          "must have time as first axis and the scan's points behind it");
    }
    const std::size_t num_bins = array.shape(0);
    if (num_bins > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
        throw core::Error("H", "found " + std::to_string(num_bins) + " bins", "must be below 2^31");
    }
    const std::size_t num_pairs = array.size() / num_bins;
    if (has_bins_fastest(array)) return borrowed(array, num_pairs);
    core::Transient transient(num_pairs, static_cast<int>(num_bins));
    const std::vector<std::int64_t> offsets = pair_offsets(array);
    const float* const values = array.data();
    const std::int64_t step = array.stride(0);
    constexpr std::size_t kPairs = 64;  // blocks that keep the rows of both arrays in the cache
    constexpr std::size_t kBins = 64;
    const nb::gil_scoped_release released;
    core::parallel_blocks(num_pairs, kPairs, [&](std::size_t begin, std::size_t end) {
        for (std::size_t first = 0; first < num_bins; first += kBins) {
            const std::size_t last = std::min(num_bins, first + kBins);
            for (std::size_t pair = begin; pair < end; ++pair) {
                const auto target = transient.histogram(pair);
                for (std::size_t b = first; b < last; ++b) {
                    target[b] = values[offsets[pair] + static_cast<std::int64_t>(b) * step];
                }
            }
        }
    });
    return transient;
}

}  // namespace python
