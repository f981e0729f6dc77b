// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/capture/capture.h"

#include <optional>

namespace nlos {

/// The same measurement with noise of the same deviation on top of its own: what comes out
/// differently is what noise may have made.
///
/// Of counts, a random half of the photons, counted twice: n = a + b with both halves Poisson, and
/// 2 a - n = a - b has no mean and the variance n. No count becomes negative, so that any method
/// can use it. Of radiance whose variance is known, a normal deviate of it is added; where a
/// background has told what a photon adds, values have the variance of that many photons.
///
/// photon    what one adds to a value of radiance; nothing: nobody knows
/// returns   scan, bins and histograms, the same for any number of threads; nothing when the noise
///           of `capture` is not known
/// source    half samples of a survey [McCarthy1969]
std::optional<core::Capture> measure_again(const core::Capture& capture,
                                           std::optional<double> photon = std::nullopt);

/// Whether a capture's own unit or variance tells its noise.
bool knows_its_noise(const core::Capture& capture);

}  // namespace nlos
