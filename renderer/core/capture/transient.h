// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <utility>
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

    /// Histograms in memory of somebody else's, num_pairs times num_bins values; copies of this
    /// hold values of their own.
    ///
    /// owner   keeps the memory while this lives
    Transient(std::size_t num_pairs, std::span<float> values, std::shared_ptr<void> owner)
        : num_pairs_(num_pairs),
          num_bins_(num_pairs > 0 ? values.size() / num_pairs : 0),
          borrowed_(values),
          owner_(std::move(owner)) {}
    Transient(Transient&&) = default;
    Transient& operator=(Transient&&) = default;
    Transient(const Transient& other)
        : num_pairs_(other.num_pairs_),
          num_bins_(other.num_bins_),
          values_(other.values().begin(), other.values().end()) {}
    Transient& operator=(const Transient& other) {
        if (this != &other) *this = Transient(other);
        return *this;
    }
    ~Transient() = default;

    std::size_t num_pairs() const { return num_pairs_; }
    std::size_t num_bins() const { return num_bins_; }
    bool empty() const { return values().empty(); }

    std::span<float> histogram(std::size_t pair) {
        return values().subspan(pair * num_bins_, num_bins_);
    }
    std::span<const float> histogram(std::size_t pair) const {
        return values().subspan(pair * num_bins_, num_bins_);
    }
    /// Adds the values of another one of the same shape.
    Transient& operator+=(const Transient& other) {
        const auto mine = values();
        const auto others = other.values();
        std::transform(mine.begin(), mine.end(), others.begin(), mine.begin(), std::plus());
        return *this;
    }

    /// Whether all values are 0.
    bool is_dark() const {
        const auto all = values();
        return std::all_of(all.begin(), all.end(), [](float v) { return v == 0.0F; });
    }

    std::span<float> values() { return owner_ ? borrowed_ : std::span<float>(values_); }
    std::span<const float> values() const {
        return owner_ ? borrowed_ : std::span<const float>(values_);
    }

 private:
    std::size_t num_pairs_ = 0;
    std::size_t num_bins_ = 0;
    std::vector<float> values_;
    std::span<float> borrowed_;    ///< instead of values_
    std::shared_ptr<void> owner_;  ///< of what is borrowed; null: nothing is
};

}  // namespace core
