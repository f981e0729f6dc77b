// SPDX-License-Identifier: MIT
// What files keep of which bins were observed.
#include "nlos/containers/array_reader.h"
#include "nlos/formats/capture_file.h"
#include "tests/nlos/formats/ytal_capture_file.h"
#include "tests/support/error_message.h"
#include "tests/support/example_capture.h"

#include <gtest/gtest.h>

namespace nlos {
namespace {

using core::BinRange;
using core::ScanPattern;
using test_support::example_capture;
using test_support::TemporaryFolder;

/// Ranges that differ from pair to pair; one point is dead.
core::Capture gated_example(ScanPattern pattern) {
    core::Capture capture = example_capture(pattern);
    std::vector<BinRange> ranges;
    for (std::size_t pair = 0; pair < capture.scan.num_pairs(); ++pair) {
        ranges.push_back({static_cast<int>(pair % 3), static_cast<int>(3 + pair % 2)});
    }
    ranges[1] = {0, 0};
    core::restrict_observed(capture, ranges);
    return capture;
}

TEST(ObservedBinsInFiles, Hdf5AndOpenExrKeepThem) {
    for (const char* suffix : {".h5", ".exr"}) {
        for (const auto pattern :
             {ScanPattern::Confocal, ScanPattern::Single, ScanPattern::Exhaustive}) {
            const core::Capture capture = gated_example(pattern);
            const TemporaryFolder folder;
            const std::string path = folder.file(std::string("capture") + suffix);
            EXPECT_TRUE(write_capture(path, capture).empty());
            const core::Capture read = read_capture(path);
            EXPECT_EQ(read.observed, capture.observed);
            EXPECT_TRUE(std::ranges::equal(read.transient.values(), capture.transient.values()));
        }
    }
}

TEST(ObservedBinsInFiles, Hdf5HoldsBeginsAndEndsAsPairsStandInH) {
    const CaptureFile file(gated_example(ScanPattern::Exhaustive));
    const ArrayReader reader(file.path());
    EXPECT_EQ(reader.shape("nlos/observed_bins"), (Shape{2, 2, 2, 3, 2}));
    const std::vector<double> bins = reader.read_doubles("nlos/observed_bins", {2, 2, 2, 3, 2});
    EXPECT_EQ(bins[2], 2.0);
    EXPECT_EQ(bins[24 + 2], 3.0);
    EXPECT_EQ(bins[3], 0.0);
    EXPECT_EQ(bins[24 + 3], 4.0);
}

/// Two frames whose gates are three bins each, of which the second begins a bin later.
core::Capture moving_gate_example() {
    core::Capture capture = example_capture(ScanPattern::Confocal);
    core::Capture before = capture;
    core::restrict_observed(before, {0, 3});
    core::restrict_observed(capture, {1, 4});
    capture.sequence = core::FrameSequence{
        {before.transient, capture.transient}, 0.0, 0.04, {before.observed, capture.observed}};
    return capture;
}

TEST(ObservedBinsInFiles, FramesKeepTheirOwn) {
    const core::Capture capture = moving_gate_example();
    const TemporaryFolder folder;
    for (const char* name : {"a.h5", "a.npz"}) {
        write_capture(folder.file(name), capture);
        const core::Capture read = read_capture(folder.file(name));
        ASSERT_TRUE(read.sequence) << name;
        EXPECT_EQ(read.sequence->observed, capture.sequence->observed) << name;
        EXPECT_EQ(read.observed, capture.observed) << name;
        CaptureReadSettings settings;
        settings.frame = 0;
        EXPECT_EQ(read_capture(folder.file(name), settings).observed_range(2), (BinRange{0, 3}));
        settings.frame.reset();
        settings.flip_t = true;
        EXPECT_EQ((*read_capture(folder.file(name), settings).observed_in_frame(0))[2],
                  (BinRange{2, 5}));
    }
}

TEST(ObservedBinsInFiles, FramesMustBeDarkOutsideTheirOwn) {
    core::Capture capture = moving_gate_example();
    capture.sequence->observed.pop_back();
    EXPECT_ERROR_WITH(validate(capture, "a"), "observed bins: found those of 1 frames");
    capture.sequence->observed.push_back(capture.sequence->observed[0]);
    EXPECT_ERROR_WITH(validate(capture, "a"), "a: frames: pair 0 holds");
}

TEST(ObservedBinsInFiles, OtherFormatsSayThatTheyDropThem) {
    core::Capture capture = example_capture(ScanPattern::Confocal);
    core::restrict_observed(capture, {1, 4});
    const TemporaryFolder folder;
    CaptureWriteSettings for_ytal;
    for_ytal.for_ytal = true;
    const auto losses = write_capture(folder.file("capture.h5"), capture, for_ytal);
    ASSERT_EQ(losses.size(), 1U);
    EXPECT_NE(losses[0].find("observed bins"), std::string::npos);
    EXPECT_FALSE(read_capture(folder.file("capture.h5")).observed);
}

TEST(ObservedBinsInFiles, DroppedLeadingBinsCountAsNotObserved) {
    const CaptureFile file(example_capture(ScanPattern::Confocal));
    CaptureReadSettings settings;
    settings.zero_bins = 2;
    const core::Capture capture = read_capture(file.path(), settings);
    EXPECT_EQ(capture.observed, core::ObservedBins(std::vector<BinRange>(6, {2, 5})));
}

TEST(ObservedBinsInFiles, WrongOnesAreRefused) {
    const auto refused =
        [](const Shape& shape, const std::vector<int>& bins, const std::string& part) {
            core::Capture capture = example_capture(ScanPattern::Confocal);
            core::restrict_observed(capture, {1, 4});
            const CaptureFile file(capture);
            file.replace<int>("nlos/observed_bins", H5T_NATIVE_INT, shape, bins);
            EXPECT_ERROR_WITH(file.read(), part);
        };
    const std::vector<int> good{1, 1, 1, 1, 1, 1, 4, 4, 4, 4, 4, 4};
    const auto with = [&](std::size_t i, int value) {
        std::vector<int> bins = good;
        bins[i] = value;
        return bins;
    };
    refused({2, 6}, good, "has shape (2, 6); must have shape (2, 3, 2)");
    refused({3, 2, 2}, good, "must have shape (2, 3, 2)");
    refused({2, 3, 2}, with(3, 5), "observed bins: pair 3 has bins 5 to 4; must");
    refused({2, 3, 2}, with(9, 6), "observed bins: pair 3 has bins 1 to 6; must");
    refused({2, 3, 2}, with(0, -1), "observed bins: pair 0 has bins -1 to 4; must");
    refused({2, 3, 2}, with(5, 2), "H: pair 5 holds");
    core::Capture capture = example_capture(ScanPattern::Confocal);
    core::restrict_observed(capture, {1, 4});
    const CaptureFile file(capture);
    file.replace<float>(
        "nlos/observed_bins", H5T_NATIVE_FLOAT, {2, 3, 2}, std::vector<float>(12, 1.5F));
    EXPECT_ERROR_WITH(file.read(), "nlos/observed_bins: found 1.5; must be bin numbers");
}

TEST(ObservedBinsInFiles, InfoSaysWhichBinsOfHowManyPairs) {
    const auto line = [](const core::Capture& capture) {
        for (const std::string& text : describe_capture(capture)) {
            if (text.starts_with("observed")) return text;
        }
        return std::string();
    };
    core::Capture capture = example_capture(ScanPattern::Confocal);
    EXPECT_EQ(line(capture), "");
    core::restrict_observed(capture, {1, 4});
    EXPECT_EQ(line(capture), "observed: bins 1 to 3 of all 6 pairs");
    core::restrict_observed(capture, {{0, 5}, {0, 0}, {0, 2}, {0, 5}, {0, 5}, {0, 5}});
    EXPECT_EQ(line(capture), "observed: bins 1 to 3 of 4 of 6 pairs; fewer of 1; 1 not at all");
    core::restrict_observed(capture, {{0, 2}, {0, 0}, {0, 2}, {2, 5}, {2, 5}, {0, 0}});
    EXPECT_EQ(line(capture), "observed: parts of bins 1 to 3 of 4 of 6 pairs; 2 not at all");
    core::restrict_observed(capture, {0, 0});
    EXPECT_EQ(line(capture), "observed: no bin of 6 pairs");
    EXPECT_EQ(std::ranges::count(describe_capture(moving_gate_example()),
                                 "each frame has its own observed bins: 0 to 2 in the first, 1 to "
                                 "3 in the last"),
              1);
}

}  // namespace
}  // namespace nlos
