// SPDX-License-Identifier: MIT
#include "apps/dataset/stored_histogram.h"

#include "nlos/formats/capture_arrays.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace apps {
namespace {

using nlos::Shape;
using nlos::StoredNumber;

template <class Count>
ItemArray as_counts(const std::string& name,
                    const Shape& shape,
                    StoredNumber number,
                    const std::vector<float>& values,
                    std::size_t& clipped) {
    constexpr auto kMost = static_cast<float>(std::numeric_limits<Count>::max());
    std::vector<Count> counts;
    counts.reserve(values.size());
    for (const float value : values) {
        clipped += value > kMost ? 1 : 0;
        counts.push_back(static_cast<Count>(std::min(value, kMost)));
    }
    return make_item_array<Count>(name, shape, number, counts);
}

void add_halves(const std::string& name,
                const Shape& shape,
                const std::vector<float>& values,
                std::vector<ItemArray>& arrays) {
    constexpr int kExponentOfMost = 15;  // numbers of half precision end at 65504
    const float most = *std::max_element(values.begin(), values.end());
    int exponent = 0;
    std::frexp(most, &exponent);
    const float scale = most > 0.0F ? std::ldexp(1.0F, exponent - kExponentOfMost) : 1.0F;
    std::vector<Eigen::half> halves;
    halves.reserve(values.size());
    for (const float value : values) halves.emplace_back(value / scale);
    arrays.push_back(make_item_array<Eigen::half>(name, shape, StoredNumber::Float16, halves));
    arrays.push_back(make_item_array<float>(
        name + "_scale", {}, StoredNumber::Float32, std::span<const float>(&scale, 1)));
}

}  // namespace

void add_histograms(const std::string& name,
                    const core::Capture& capture,
                    HistogramStorage storage,
                    Item& item) {
    const Shape shape = nlos::histogram_shape(capture);
    std::vector<float> values(capture.transient.values().size());
    nlos::copy_rows(capture.transient, 0, shape[0], values.data());
    switch (storage) {
        case HistogramStorage::Float32:
            item.arrays.push_back(
                make_item_array<float>(name, shape, StoredNumber::Float32, values));
            return;
        case HistogramStorage::Float16:
            return add_halves(name, shape, values, item.arrays);
        case HistogramStorage::Uint8:
            item.arrays.push_back(as_counts<std::uint8_t>(
                name, shape, StoredNumber::UInt8, values, item.clipped_counts));
            return;
        case HistogramStorage::Uint16:
            item.arrays.push_back(as_counts<std::uint16_t>(
                name, shape, StoredNumber::UInt16, values, item.clipped_counts));
            return;
    }
}

}  // namespace apps
