// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/random.h"

#include <cstdint>

namespace nlos {

/// Draws from the Poisson distribution, exactly.
///
/// mean      finite, not negative
/// source    inversion below a mean of 10, transformed rejection above [Hoermann1993a]
std::int64_t sample_poisson(core::Rng& rng, double mean);

/// Draws how many of `trials` succeed, exactly.
///
/// trials        not negative
/// probability   of success, in [0, 1]
/// source        inversion below 10 expected successes, transformed rejection above [Hoermann1993b]
std::int64_t sample_binomial(core::Rng& rng, std::int64_t trials, double probability);

}  // namespace nlos
