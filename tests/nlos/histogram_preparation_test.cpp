// SPDX-License-Identifier: MIT
#include "nlos/histogram_preparation.h"

#include <gtest/gtest.h>

namespace nlos {
namespace {

/// Two pairs: 20 empty bins, then ambient light of 2 and 5 counts, a signal in bins [40, 80).
core::Transient example() {
    core::Transient transient(2, 340);
    for (std::size_t pair = 0; pair < 2; ++pair) {
        for (std::size_t bin = 20; bin < 340; ++bin) {
            const float ambient = pair == 0 ? 2.0F : 5.0F;
            transient.histogram(pair)[bin] = ambient + (bin >= 40 && bin < 80 ? 100.0F : 0.0F);
        }
    }
    return transient;
}

TEST(HistogramPreparation, FindsAmbientLightAndTheSignalsEnd) {
    const auto signal = find_signal(example());
    ASSERT_TRUE(signal);
    EXPECT_DOUBLE_EQ(signal->ambient_per_bin[0], 2.0);
    EXPECT_DOUBLE_EQ(signal->ambient_per_bin[1], 5.0);
    EXPECT_EQ(signal->end_bin, 80);
}

TEST(HistogramPreparation, KeepsTheWholeAxisWithoutASignal) {
    core::Transient transient(1, 320);
    for (float& value : transient.values()) value = 3.0F;
    const auto signal = find_signal(transient);
    ASSERT_TRUE(signal);
    EXPECT_EQ(signal->end_bin, 320);
    EXPECT_FALSE(find_signal(core::Transient(1, 320)));
}

TEST(HistogramPreparation, TakesOffAmbientLightAndAddsUpBins) {
    const PreparationPlan plan{4, 20, {2.0, 5.0}};
    const core::Transient prepared = prepare_histograms(example(), plan);
    ASSERT_EQ(prepared.num_bins(), 20U);
    for (std::size_t pair = 0; pair < 2; ++pair) {
        for (std::size_t bin = 0; bin < 20; ++bin) {
            EXPECT_FLOAT_EQ(prepared.histogram(pair)[bin], bin >= 10 ? 400.0F : 0.0F);
        }
    }
}

}  // namespace
}  // namespace nlos
