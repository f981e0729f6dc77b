// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/random.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace nlos {

/// The time grid of a detector that goes blind: laser pulses one period apart, each followed by the
/// bins of the axis and then by a gap.
struct PulseTrain {
    std::int64_t pulses = 1;
    std::size_t gap_bins = 0;    ///< from the axis' end to its start after the next pulse
    double gap_rate = 0.0;       ///< expected photons per pulse in a bin of the gap
    std::size_t blind_bins = 0;  ///< after the bin of a detection
    bool first_photon_only = false;
};

/// Counts of a detector that is blind after each detection; nothing in a bin after its first photon
/// is recorded either.
///
/// Every pulse is followed as if it had a detector of its own, in the state that many earlier
/// pulses leave it in. Of A detectors that can see, each detects in a bin of rate r with
/// probability 1 - exp(-r): a binomial number of them, and these are blind from there on. Detectors
/// in light so bright that they never forget when they were first hit, stay as they began: hit as
/// often as in steady light.
///
/// rates     expected photons per pulse in each bin of the axis
/// rng       null: expected counts
/// returns   counts over all pulses in each bin of the axis
std::vector<double> count_with_dead_time(std::span<const double> rates,
                                         const PulseTrain& train,
                                         core::Rng* rng);

}  // namespace nlos
