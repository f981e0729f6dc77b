// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/film/transient_accumulator.h"
#include "renderer/settings/render_settings.h"

#include <optional>

namespace renderer {

/// What is known of H before sampling starts.
struct PrecomputedPart {
    const core::Transient* transient = nullptr;  ///< to be added to what is sampled; null: nothing
    double squared_error = 0.0;  ///< of it, and of what is left out [squared L2 norm]
    double left_out = 0.0;       ///< relative L2 over all of H of orders that are left out
};

/// Relative L2 error over all of H, from norms over all pairs and bins.
///
/// returns   0 when nothing is uncertain, even where there is no signal
double relative_error(const TransientAccumulator::SquaredNorms& norms,
                      const PrecomputedPart& precomputed);

/// The noise that is allowed if the rest of the error is to leave relative_error() below a target;
/// where the rest alone exceeds the target, noise is brought down to the target [squared L2 norm].
///
/// signal   squared L2 norm over all of H
double allowed_noise(double signal, double target, const PrecomputedPart& precomputed);

/// When to stop rendering passes: after a number of them, after some time, or when the error
/// estimated from their spread is below the target. A target needs at least a few passes for the
/// spread to be reliable.
class StoppingRule {
 public:
    /// passes_for_samples   that `samples` asks for; counts when neither time nor target is set
    StoppingRule(const RenderSettings& settings,
                 int passes_for_samples,
                 const PrecomputedPart& precomputed);

    /// To be called after each pass.
    ///
    /// elapsed_s   since the first pass began
    /// returns     the fraction of the work done so far; 1: enough
    double fraction_done(int passes, double elapsed_s, const TransientAccumulator& sums);

 private:
    double fraction_of_target(int passes, const TransientAccumulator& sums);

    std::optional<double> seconds_;
    std::optional<double> target_;
    int passes_for_samples_;
    PrecomputedPart precomputed_;
    int next_look_;
    double predicted_passes_ = 0.0;
};

}  // namespace renderer
