// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace core {

/// Histograms of optical path length, one per measurement pair; stored [pair][bin], bin fastest.
/// A bin holds the integral over the bin.
class Transient {
 public:
    Transient() = default;
    Transient(std::size_t num_pairs, int num_bins)
        : num_pairs_(num_pairs),
          num_bins_(static_cast<std::size_t>(num_bins)),
          values_(num_pairs_ * num_bins_, 0.0F) {}

    std::size_t num_pairs() const { return num_pairs_; }
    std::size_t num_bins() const { return num_bins_; }
    bool empty() const { return values_.empty(); }

    std::span<float> histogram(std::size_t pair) {
        return {values_.data() + pair * num_bins_, num_bins_};
    }
    std::span<const float> histogram(std::size_t pair) const {
        return {values_.data() + pair * num_bins_, num_bins_};
    }
    /// Whether all values are 0.
    bool is_dark() const {
        return std::all_of(values_.begin(), values_.end(), [](float v) { return v == 0.0F; });
    }

    std::span<float> values() { return values_; }
    std::span<const float> values() const { return values_; }

 private:
    std::size_t num_pairs_ = 0;
    std::size_t num_bins_ = 0;
    std::vector<float> values_;
};

}  // namespace core
