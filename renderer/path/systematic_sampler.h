// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/random.h"

namespace renderer {

/// Draws few of many values, in their order, so that any run of them gets its part (source
/// [Madow1949], systematic sampling).
class SystematicSampler {
 public:
    /// step   values from it on are all drawn; of the others as many as have steps in their sum
    SystematicSampler(double step, core::Rng& rng) : step_(step), left_(rng.uniform() * step) {}

    /// What the next value counts, with itself for a mean: itself, a step, or 0 where it is not
    /// drawn. A step that is no number draws every value, so that what is wrong is counted.
    double draw(double value) {
        if (value >= step_) return value;
        left_ -= value;
        if (left_ >= 0.0) return 0.0;
        left_ += step_;
        return step_;
    }

 private:
    double step_;
    double left_;
};

}  // namespace renderer
