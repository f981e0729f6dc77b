// SPDX-License-Identifier: MIT
#include "renderer/core/capture/observed_bins.h"

#include "renderer/core/capture/capture.h"
#include "tests/support/error_message.h"
#include "tests/support/example_capture.h"

#include <gtest/gtest.h>

namespace core {
namespace {

using test_support::example_capture;

TEST(ObservedBins, RangesMeetAndMerge) {
    EXPECT_EQ(intersection({2, 7}, {5, 9}), (BinRange{5, 7}));
    EXPECT_EQ(intersection({2, 5}, {5, 9}).size(), 0);
    EXPECT_EQ(merged({3, 13}, 4), (BinRange{1, 3}));
    EXPECT_EQ(merged({3, 7}, 4).size(), 0);
    EXPECT_EQ(merged({4, 8}, 4), (BinRange{1, 2}));
    const ObservedBins ranges = std::vector<BinRange>{{4, 6}, {0, 0}, {5, 9}};
    EXPECT_EQ(observed_hull(ranges, 20), (BinRange{4, 9}));
    EXPECT_EQ(observed_count(ranges, 3, 20), 6U);
    EXPECT_EQ(observed_hull(std::nullopt, 20), (BinRange{0, 20}));
    EXPECT_EQ(observed_hull(std::vector<BinRange>{{3, 3}}, 20).size(), 0);
}

TEST(ObservedBins, RestrictingThemSetsAllElseToZero) {
    Capture capture = example_capture(ScanPattern::Confocal);
    capture.variance = capture.transient;
    capture.orders = {3};
    capture.by_order = {capture.transient};
    capture.sequence = FrameSequence{{capture.transient}, 0.0, 0.0};
    capture.velocity = VelocityHistogram{{.num_bins = 2, .with_time = true}, Transient(6, 10), {}};
    for (float& value : capture.velocity->values.values()) value = 1.0F;
    const Capture whole = capture;
    restrict_observed(capture, {1, 4});
    std::vector<BinRange> ranges(6, {0, 5});
    ranges[2] = {0, 3};
    ranges[4] = {0, 0};
    restrict_observed(capture, ranges);
    for (std::size_t pair = 0; pair < 6; ++pair) {
        const BinRange range = capture.observed_range(pair);
        EXPECT_EQ(range, pair == 4 ? BinRange{} : (BinRange{1, pair == 2 ? 3 : 4}));
        for (int bin = 0; bin < 5; ++bin) {
            const auto i = static_cast<std::size_t>(bin);
            const float kept = range.holds(bin) ? whole.transient.histogram(pair)[i] : 0.0F;
            EXPECT_EQ(capture.transient.histogram(pair)[i], kept);
            EXPECT_EQ(capture.variance->histogram(pair)[i], kept);
            EXPECT_EQ(capture.by_order[0].histogram(pair)[i], kept);
            EXPECT_EQ(capture.sequence->frames[0].histogram(pair)[i], kept);
            const float moving = range.holds(bin) ? 1.0F : 0.0F;
            EXPECT_EQ(capture.velocity->values.histogram(pair)[i], moving);
            EXPECT_EQ(capture.velocity->values.histogram(pair)[5 + i], moving);
        }
    }
    EXPECT_NO_THROW(validate(capture, "capture"));
}

TEST(ObservedBins, AllOfThemAreNothingToSay) {
    Capture capture = example_capture(ScanPattern::Single);
    restrict_observed(capture, {0, 5});
    EXPECT_FALSE(capture.observed);
}

TEST(ObservedBins, WrongRangesAreRefused) {
    const auto refused = [](std::vector<BinRange> ranges, const std::string& part) {
        Capture capture = example_capture(ScanPattern::Confocal);
        EXPECT_ERROR_WITH(restrict_observed(capture, ranges), part);
        capture.observed = ranges;
        EXPECT_ERROR_WITH(validate(capture, "x.h5"), "x.h5: observed bins: ");
        EXPECT_ERROR_WITH(validate(capture, "x.h5"), part);
    };
    refused(std::vector<BinRange>(5, {0, 5}), "5 ranges");
    refused(std::vector<BinRange>(6, {0, 6}), "pair 0 has bins 0 to 6; must");
    refused(std::vector<BinRange>(6, {-1, 4}), "pair 0 has bins -1 to 4");
    refused({{0, 5}, {0, 5}, {3, 2}, {0, 5}, {0, 5}, {0, 5}}, "pair 2 has bins 3 to 2");
}

TEST(ObservedBins, LightWhereNobodyLookedIsRefused) {
    Capture capture = example_capture(ScanPattern::Confocal);
    capture.observed = std::vector<BinRange>(6, {0, 5});
    (*capture.observed)[3] = {1, 5};
    EXPECT_ERROR_WITH(validate(capture, "x.h5"), "x.h5: H: pair 3 holds 16.5");
    capture.transient.histogram(3)[0] = 0.0F;
    EXPECT_NO_THROW(validate(capture, "x.h5"));
    capture.variance = example_capture(ScanPattern::Confocal).transient;
    EXPECT_ERROR_WITH(validate(capture, "x.h5"), "x.h5: variance: pair 3");
}

TEST(ObservedBins, ImagesHaveNone) {
    Capture image = test_support::example_image();
    restrict_observed(image, {2, 5});
    EXPECT_FALSE(image.observed);
    EXPECT_EQ(image.transient.histogram(0)[1], 0.0F);
    image.observed = std::vector<BinRange>(6, {2, 5});
    EXPECT_ERROR_WITH(validate(image, "x.h5"), "observed bins: found for an image");
}

}  // namespace
}  // namespace core
