// SPDX-License-Identifier: MIT
// What sums over reservoirs say of the noise of reuse, against noise that is made up.
#include "renderer/restir/reuse_statistics.h"

#include "renderer/core/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace {

using renderer::PathReservoir;
using renderer::ReuseStatistics;

constexpr int kPairs = 400'000;

PathReservoir reservoir_of(double estimate, double confidence) {
    PathReservoir reservoir;
    reservoir.target_value = 2.0;
    reservoir.contribution_weight = estimate / 2.0;
    reservoir.confidence = confidence;
    return reservoir;
}

// Mean 1; only its variance matters here.
double noise(double variance, core::Rng& rng) {
    const double value = 1.0 + std::sqrt(12.0 * variance) * (rng.uniform() - 0.5);
    return std::max(0.0, value);
}

// Light that differs by pair, candidates of one frame, and a past of some frames whose path keeps
// its value, times a ratio, for some of the pairs alone.
struct Model {
    double frame_variance = 0.2;
    double frames = 8.0;
    double kept = 0.7;            ///< part of the pairs whose path has an image
    double ratio_variance = 0.1;  ///< of those
    double fresh_variance = 0.2;  ///< after spatial reuse

    double shift_variance() const { return kept * (1.0 + ratio_variance) - kept * kept; }

    ReuseStatistics statistics() const {
        core::Rng rng(7, 0, 0);
        ReuseStatistics sums;
        for (int i = 0; i < kPairs; ++i) {
            const double light = 1.0 + rng.uniform();
            const double candidates = light * noise(frame_variance, rng);
            sums.candidates += candidates * candidates;
            sums.candidate_variance += frame_variance * light * light;
            const PathReservoir fresh = reservoir_of(light * noise(fresh_variance, rng), 1.0);
            sums.fresh += fresh.estimate() * fresh.estimate();
            const PathReservoir past =
                reservoir_of(light * noise(frame_variance / frames, rng), frames);
            renderer::ShiftedSample image;
            if (rng.uniform() < kept) {
                image.emplace();
                image->target_value = past.target_value * noise(ratio_variance, rng);
            }
            sums.add_shift(fresh, past, image);
        }
        return sums;
    }
};

TEST(ReuseStatistics, TellTheNoiseOfShifts) {
    for (const double kept : {1.0, 0.7, 0.3}) {
        Model model;
        model.kept = kept;
        const double expected = model.shift_variance() / model.frame_variance;
        EXPECT_NEAR(model.statistics().shift_noise(), expected, 0.07 * expected) << kept;
    }
}

TEST(ReuseStatistics, TellThatShiftsAddNoNoise) {
    Model model;
    model.kept = 1.0;
    model.ratio_variance = 0.0;
    EXPECT_LT(model.statistics().shift_noise(), 0.05);
}

TEST(ReuseStatistics, TellWhatSpatialReuseGains) {
    Model model;
    for (const double gain : {0.5, 1.0, 3.0}) {
        model.fresh_variance = model.frame_variance / gain;
        EXPECT_NEAR(model.statistics().gain_of_spatial_reuse(), gain, 0.1 * gain);
    }
}

TEST(ReuseStatistics, KnowNothingOfDarkness) {
    const ReuseStatistics nothing;
    EXPECT_EQ(nothing.shift_noise(), 1.0);
    EXPECT_EQ(nothing.gain_of_spatial_reuse(), 1.0);
    EXPECT_EQ(nothing.mean_past_frames(), 0.0);
}

}  // namespace
