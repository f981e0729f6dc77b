// SPDX-License-Identifier: MIT
#include "nlos/preparation/second_capture.h"

#include "nlos/detector/count_sampling.h"
#include "renderer/core/random.h"
#include "renderer/core/system/parallel.h"
#include "renderer/core/types.h"

#include <algorithm>
#include <cmath>

namespace nlos {
namespace {

constexpr std::uint64_t kSeed = 0x5ec0d;

/// Twice as many as are in a random half. Of the part of an expected count that is no whole photon,
/// a number of the same mean and of that variance.
double resampled_count(core::Rng& rng, double count) {
    if (!(count > 0.0)) return count;
    const double whole = std::floor(count);
    const double part = count - whole;
    double result =
        2.0 * static_cast<double>(sample_binomial(rng, static_cast<std::int64_t>(whole), 0.5));
    if (part > 0.0 && rng.uniform() < part / (1.0 + part)) result += 1.0 + part;
    return result;
}

/// A standard normal deviate [Box1958].
double normal_deviate(core::Rng& rng) {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - rng.uniform()));
    return radius * std::cos(2.0 * core::kPi * rng.uniform());
}

}  // namespace

bool knows_its_noise(const core::Capture& capture) {
    if (capture.unit == core::TransientUnit::Counts) return true;
    if (!capture.variance) return false;
    return std::ranges::any_of(capture.variance->values(), [](float v) { return v > 0.0F; });
}

std::optional<core::Capture> measure_again(const core::Capture& capture,
                                           std::optional<double> photon) {
    const bool is_known = knows_its_noise(capture);
    if (!is_known && !photon) return std::nullopt;
    core::Capture again;
    again.scan = capture.scan;
    again.time_axis = capture.time_axis;
    again.transient = capture.transient;
    again.observed = capture.observed;
    again.unit = capture.unit;
    core::parallel_for(again.transient.num_pairs(), [&](std::size_t pair) {
        core::Rng rng(kSeed, pair, 0);
        const auto histogram = again.transient.histogram(pair);
        for (std::size_t bin = 0; bin < histogram.size(); ++bin) {
            const double value = histogram[bin];
            if (capture.unit == core::TransientUnit::Counts) {
                histogram[bin] = static_cast<float>(resampled_count(rng, value));
            } else {
                const double variance = is_known ? double{capture.variance->histogram(pair)[bin]}
                                                 : *photon * std::max(0.0, value);
                histogram[bin] =
                    static_cast<float>(value + std::sqrt(variance) * normal_deviate(rng));
            }
        }
    });
    return again;
}

}  // namespace nlos
