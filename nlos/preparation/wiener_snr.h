// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/preparation/histogram_preparation.h"
#include "nlos/reconstruction/reconstruct_settings.h"
#include "renderer/core/capture/capture.h"

namespace nlos {

/// Signal to noise ratio of the Wiener filter of the light-cone transform when nothing is known of
/// the noise: what the model leaves out (cosines, occlusion) counts as noise of the signal's power.
inline constexpr double kNoiselessSnr = 1.0;

/// The same ratio from photon counts, which tell their own noise.
///
/// The filter adds 1/snr to a kernel of mean squared magnitude 1: for data K f + n, with f and n
/// white, the best is 1/snr = |n|^2 / |K f|^2. The transform multiplies bins of range r by r^p and
/// moves them to bins of r^2, where a bin of range is as wide as 2 r: each counts with the weight
/// r^(2p) / (2 r). The noise of a count is the count; what exceeds it in the sum of squares is the
/// signal. The model's own error adds to it, so that
///
///     1/snr = 1/kNoiselessSnr + sum w n / sum w ((n - b)^2 - n),    n counts, b of them ambient.
///
/// scan, axis, counts   of a confocal measurement; not merged, ambient light included
/// plan                 what is done to the histograms before the method sees them; bins that were
///                      not observed count on neither side
/// returns              positive; at least 0.001, where the counts hold no signal
/// source               [Wiener1949]
double wiener_snr(const core::WallScan& scan,
                  const core::TimeAxis& axis,
                  const core::Transient& counts,
                  const PreparationPlan& plan,
                  Falloff falloff);

}  // namespace nlos
