// SPDX-License-Identifier: MIT
#pragma once

#include "calib/track/track_settings.h"

#include <cstddef>
#include <span>
#include <vector>

namespace calib {

/// What a sensor counts without targets, learnt from its frames; [zone][bin].
///
/// First from a number of frames, without those that stand out in a bin; then every frame adds the
/// fraction of its counts that the targets do not explain (a step of expectation maximisation), so
/// that the background follows slow changes while targets are there.
class Background {
 public:
    Background(const BackgroundSettings& settings, std::size_t num_zones, std::size_t num_bins);

    /// Whether enough frames were seen for targets to be looked for.
    bool is_ready() const { return frames_seen_ > 0.0; }

    /// Takes a frame before is_ready(); weights of 0 mark bins that say nothing.
    void learn(std::span<const double> counts, std::span<const double> weights);

    /// Learns from all of these frames at once and is ready. Throws core::Error without any.
    void learn_all(const std::vector<std::vector<double>>& frames, std::span<const double> weights);

    /// Takes a frame of which the targets explain `signal`.
    void follow(std::span<const double> counts,
                std::span<const double> weights,
                std::span<const double> signal);

    const std::vector<double>& mean() const { return mean_; }

    /// Whether a zone that counted nothing must be dead, where so many counts were expected and
    /// vary by `dispersion` times as much as Poisson's.
    bool makes_suspicious(double awaited, double dispersion) const;

    /// Variance of a bin's count beside what is expected, relative to its Poisson variance: the
    /// background is itself known from so many frames only.
    double excess_variance() const { return 1.0 / frames_seen_; }

 private:
    bool is_flat() const { return settings_.kind == BackgroundKind::Flat; }
    void average(const std::vector<std::vector<double>>& frames);
    void set_levels(std::span<const double> counts, std::span<const double> weights);

    BackgroundSettings settings_;
    std::size_t num_bins_;
    std::vector<std::vector<double>> first_;
    std::vector<double> mean_;
    double frames_seen_ = 0.0;
};

}  // namespace calib
