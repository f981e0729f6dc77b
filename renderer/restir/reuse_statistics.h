// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/restir/restir_frame.h"

namespace renderer {

/// Sums over the reservoirs of frames from which follows how noisy their estimates are, and what
/// reuse adds to that noise.
///
/// Let X be what the candidates of a frame estimate of a pair's light mu, with the variance v mu^2,
/// and Z what a path of the frame before estimates once it is shifted. Its past represents c frames
/// and has the variance v mu^2 / c. The shift multiplies it by a ratio R that has nothing to do
/// with it: R is 0 where the path has no image, and varies with the path elsewhere. Hence
///
///     E[X Z] = mu^2 E[R],   E[Z^2] = mu^2 (1 + v / c) (E[R]^2 + s^2),
///
/// and the variance s^2 of R, which no number of frames makes smaller, follows from sums over
/// pairs.
struct ReuseStatistics {
    double candidates = 0.0;          ///< X^2
    double candidate_variance = 0.0;  ///< estimates of v mu^2, see RestirRenderer::FrameInput
    double fresh = 0.0;               ///< X^2 after spatial reuse
    double covered = 0.0;             ///< X Z
    double shifted = 0.0;             ///< Z^2
    double shifted_per_frame = 0.0;   ///< Z^2 / c
    double past_frames = 0.0;         ///< frames that the pasts were taken to be worth
    double num_pasts = 0.0;

    void add_shift(const PathReservoir& fresh_one,
                   const PathReservoir& past,
                   const ShiftedSample& image);

    /// Adds other sums to `kept` times these.
    void add(const ReuseStatistics& others, double kept = 1.0);

    /// s^2 / v: a past of c frames, shifted as one path, is worth c / (1 + c * this) of them. 1
    /// where nothing is known.
    double shift_noise() const;

    /// Variance of the candidates over that after spatial reuse.
    double gain_of_spatial_reuse() const;

    /// Mean number of frames that the past was worth; 0 without a past.
    double mean_past_frames() const { return num_pasts > 0.0 ? past_frames / num_pasts : 0.0; }

 private:
    double squared_light() const;
};

}  // namespace renderer
