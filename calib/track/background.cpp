// SPDX-License-Identifier: MIT
#include "calib/track/background.h"

#include "renderer/core/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace calib {
namespace {

constexpr double kOutlierSigmas = 4.0;
// A bin that has never counted may still count one day: half a count in all frames seen.
constexpr double kPriorCounts = 0.5;

}  // namespace

Background::Background(const BackgroundSettings& settings,
                       std::size_t num_zones,
                       std::size_t num_bins)
    : settings_(settings), num_bins_(num_bins), mean_(num_zones * num_bins, kPriorCounts) {}

void Background::learn(std::span<const double> counts, std::span<const double> weights) {
    if (is_flat()) {
        set_levels(counts, weights);
        return;
    }
    first_.emplace_back(counts.begin(), counts.end());
    if (first_.size() < static_cast<std::size_t>(settings_.frames)) return;
    average(first_);
    first_.clear();
}

// Where the background was subtracted already, something is always left of it.
bool Background::makes_suspicious(double awaited, double dispersion) const {
    constexpr double kDeadCounts = 30.0;
    return is_flat() || awaited > kDeadCounts * dispersion;
}

void Background::learn_all(const std::vector<std::vector<double>>& frames,
                           std::span<const double> weights) {
    if (is_flat()) {
        set_levels(frames.front(), weights);
    } else {
        average(frames);
    }
}

void Background::average(const std::vector<std::vector<double>>& frames) {
    std::vector<double> values(frames.size());
    for (std::size_t i = 0; i < mean_.size(); ++i) {
        for (std::size_t f = 0; f < frames.size(); ++f) values[f] = frames[f][i];
        const double center = core::upper_median(values);
        const double limit = center + kOutlierSigmas * std::sqrt(center + 1.0);
        double sum = kPriorCounts;
        double count = 0.0;
        for (const double value : values) {
            if (value > limit) continue;
            sum += value;
            count += 1.0;
        }
        mean_[i] = sum / std::max(count, 1.0);
    }
    frames_seen_ = static_cast<double>(frames.size());
}

// The mean of a zone's bins, without those that stand out.
void Background::set_levels(std::span<const double> counts, std::span<const double> weights) {
    for (std::size_t begin = 0; begin < mean_.size(); begin += num_bins_) {
        double limit = std::numeric_limits<double>::infinity();
        double level = kPriorCounts;
        for (int pass = 0; pass < 3; ++pass) {
            double sum = kPriorCounts;
            double square = 0.0;
            double count = 0.0;
            for (std::size_t i = begin; i < begin + num_bins_; ++i) {
                if (weights[i] == 0.0 || counts[i] > limit) continue;
                sum += counts[i];
                square += counts[i] * counts[i];
                count += 1.0;
            }
            count = std::max(count, 1.0);
            level = sum / count;
            limit = level + 2.0 * std::sqrt(std::max(square / count - level * level, 0.0));
        }
        std::fill_n(mean_.begin() + static_cast<std::ptrdiff_t>(begin), num_bins_, level);
    }
    frames_seen_ = static_cast<double>(num_bins_) / 2.0;
}

void Background::follow(std::span<const double> counts,
                        std::span<const double> weights,
                        std::span<const double> signal) {
    frames_seen_ = std::min(frames_seen_ + 1.0, static_cast<double>(settings_.memory_frames));
    const double gain = 1.0 / frames_seen_;
    const auto explained = [&](std::size_t i) {
        return counts[i] * mean_[i] / (mean_[i] + signal[i]);
    };
    for (std::size_t begin = 0; begin < mean_.size(); begin += num_bins_) {
        double sum = 0.0;
        double count = 0.0;
        for (std::size_t i = begin; i < begin + num_bins_; ++i) {
            if (weights[i] == 0.0) continue;
            if (!is_flat()) {
                mean_[i] += gain * (explained(i) - mean_[i]);
                mean_[i] = std::max(mean_[i], kPriorCounts / settings_.memory_frames);
            }
            sum += explained(i);
            count += 1.0;
        }
        if (!is_flat() || count == 0.0) continue;
        const double level = mean_[begin] + gain * (sum / count - mean_[begin]);
        std::fill_n(mean_.begin() + static_cast<std::ptrdiff_t>(begin),
                    num_bins_,
                    std::max(level, kPriorCounts / settings_.memory_frames));
    }
}

}  // namespace calib
