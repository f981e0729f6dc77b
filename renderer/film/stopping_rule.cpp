// SPDX-License-Identifier: MIT
#include "renderer/film/stopping_rule.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace renderer {
namespace {

constexpr int kMinPasses = 8;     // the standard deviation is then known to a quarter
constexpr double kMaxGrowth = 2;  // of the number of passes between two checks of the error

}  // namespace

double relative_error(const TransientAccumulator::SquaredNorms& norms,
                      const PrecomputedPart& precomputed) {
    const double squared = norms.noise + precomputed.squared_error;
    const double sampled = norms.signal > 0.0
                               ? std::sqrt(squared / norms.signal)
                               : (squared > 0.0 ? std::numeric_limits<double>::infinity() : 0.0);
    return std::hypot(sampled, precomputed.left_out);
}

// Noise falls with the number of samples, the rest of the error stays.
double allowed_noise(double signal, double target, const PrecomputedPart& precomputed) {
    const double rest = relative_error({0.0, signal}, precomputed);
    return signal * (rest < target ? target * target - rest * rest : target * target);
}

StoppingRule::StoppingRule(const RenderSettings& settings,
                           int passes_for_samples,
                           const PrecomputedPart& precomputed)
    : seconds_(settings.seconds),
      target_(settings.target_error),
      passes_for_samples_(passes_for_samples),
      precomputed_(precomputed),
      next_look_(kMinPasses),
      predicted_passes_(kMinPasses) {}

double StoppingRule::fraction_done(int passes, double elapsed_s, const TransientAccumulator& sums) {
    if (seconds_) return std::min(1.0, elapsed_s / *seconds_);
    if (target_) return fraction_of_target(passes, sums);
    return static_cast<double>(passes) / passes_for_samples_;
}

double StoppingRule::fraction_of_target(int passes, const TransientAccumulator& sums) {
    if (passes >= next_look_) {
        const auto norms = sums.squared_norms(passes, precomputed_.transient);
        const double allowed = allowed_noise(norms.signal, *target_, precomputed_);
        if (norms.noise <= allowed) return 1.0;
        const double needed =
            allowed > 0.0 ? passes * norms.noise / allowed : std::numeric_limits<double>::max();
        predicted_passes_ =
            std::clamp(needed, passes + 1.0, static_cast<double>(std::numeric_limits<int>::max()));
        next_look_ = static_cast<int>(std::min(std::ceil(predicted_passes_), kMaxGrowth * passes));
    }
    return std::min(0.99, passes / predicted_passes_);
}

}  // namespace renderer
