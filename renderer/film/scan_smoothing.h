// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"

#include <cstddef>
#include <optional>

namespace renderer {

/// How far a value is averaged over its neighbours: over those closer than this, with weights that
/// fall linearly. 1: not at all.
struct SmoothingWidths {
    int points = 1;  ///< along both sides of every grid of wall points
    int bins = 1;

    bool is_none() const { return points == 1 && bins == 1; }
};

/// Averages histograms over neighbouring wall points and bins. Their sum over the scan is kept: at
/// borders, weights are mirrored. Points in a list have no neighbours.
///
/// scan   of the pairs of `transient`; no image
core::Transient smooth_scan(const core::Transient& transient,
                            const core::WallScan& scan,
                            const SmoothingWidths& widths);

/// The mean of two estimates, smoothed, and what is known of it.
struct SmoothedMean {
    core::Transient mean;
    SmoothingWidths widths;
    double squared_error = 0.0;   ///< expected, of the mean about the truth [squared L2 norm]
    double squared_noise = 0.0;   ///< the part of it that more samples lower
    double squared_signal = 0.0;  ///< of `precomputed` plus the truth
};

/// Averages two independent, unbiased estimates of the same histograms, and smooths the mean over
/// the widths that leave the least error.
///
/// With M the mean, D the difference and S the smoothing, |S D|^2 / 4 is the noise that is left,
/// and |M - S M|^2 - |D - S D|^2 / 4 has the squared bias of S as its expectation, whatever the
/// noise is. One standard deviation of it, from its spread over pairs, is added.
///
/// precomputed   what is to be added to them from elsewhere, of their shape; null: nothing
/// source        risk from independent halves of the samples, as in [Rousselle2012]
SmoothedMean smooth_mean(const core::Transient& a,
                         const core::Transient& b,
                         const core::WallScan& scan,
                         const core::Transient* precomputed);

}  // namespace renderer
