// SPDX-License-Identifier: MIT
#include "nlos/layouts/histogram_evidence.h"

#include "nlos/containers/writers/npz_writer.h"
#include "nlos/formats/capture_file.h"
#include "nlos/layouts/layout_guess.h"
#include "renderer/core/random.h"
#include "tests/support/error_message.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

namespace nlos {
namespace {

using test_support::TemporaryFolder;

/// The evidence on an array whose values follow from their indices.
HistogramEvidence evidence_on(const Shape& shape,
                              const std::function<double(const std::vector<std::size_t>&)>& value) {
    std::vector<double> values;
    std::vector<std::size_t> index(shape.size(), 0);
    for (std::uint64_t i = 0; i < total_bytes(shape, 1); ++i) {
        values.push_back(value(index));
        for (std::size_t axis = shape.size(); axis-- > 0;) {
            if (++index[axis] < shape[axis]) break;
            index[axis] = 0;
        }
    }
    const TemporaryFolder folder;
    NpzWriter file(folder.file("a.npz"));
    file.write("a", shape, values);
    file.finish();
    return weigh_as_histograms(LayoutFiles(folder.file("a.npz")), "a");
}

/// Expected light of wall point `point` of a square, which comes back late and fades.
double light_at(std::size_t point, std::size_t side, std::size_t bin, std::size_t bins) {
    const double x = static_cast<double>(point / side) / static_cast<double>(side) - 0.5;
    const double y = static_cast<double>(point % side) / static_cast<double>(side) - 0.3;
    const double first = static_cast<double>(bins) * (0.25 + 0.3 * std::hypot(x, y));
    const double late = static_cast<double>(bin) - first;
    return late < 0.0 ? 0.0 : std::exp(-late / 4.0) / (0.2 + x * x + y * y);
}

TEST(HistogramEvidence, FindsTimeInCubesAndListsOfAnyOrder) {
    const auto cube = [](std::size_t x, std::size_t y, std::size_t t) {
        return light_at(12 * x + y, 12, t, 48);
    };
    const HistogramEvidence last =
        evidence_on({12, 12, 48}, [&](const auto& i) { return cube(i[0], i[1], i[2]); });
    EXPECT_EQ(last.why_not, "");
    EXPECT_EQ(last.time_axis, 2U);
    EXPECT_EQ(
        evidence_on({48, 12, 12}, [&](const auto& i) { return cube(i[1], i[2], i[0]); }).time_axis,
        0U);
    EXPECT_EQ(evidence_on({144, 48}, [](const auto& i) { return light_at(i[0], 12, i[1], 48); })
                  .time_axis,
              1U);
}

TEST(HistogramEvidence, NoiseOfManyPointsWithFewCountsIsNotTakenForTime) {
    // Each of 4096 points holds about four counts, ambient light most of them.
    const auto counts = [](std::size_t point, std::size_t bin) {
        core::Rng rng(7, point, bin);
        const double mean = 0.02 + 0.06 * light_at(point, 64, bin, 64);
        return rng.uniform() < mean ? 1.0 : 0.0;
    };
    const HistogramEvidence list =
        evidence_on({4096, 64}, [&](const auto& i) { return counts(i[0], i[1]); });
    EXPECT_EQ(list.why_not, "");
    EXPECT_EQ(list.time_axis, 1U);
    const HistogramEvidence turned =
        evidence_on({64, 4096}, [&](const auto& i) { return counts(i[1], i[0]); });
    EXPECT_EQ(turned.time_axis, 0U);
}

TEST(HistogramEvidence, MapsPhotographsAndPosesAreNone) {
    const double inf = std::numeric_limits<double>::infinity();
    const auto on_object = [](const std::vector<std::size_t>& i) {
        return i[0] > 8 && i[0] < 24 && i[1] > 12 && i[1] < 20;
    };
    const auto expect = [](const HistogramEvidence& evidence, const std::string& part) {
        EXPECT_NE(evidence.why_not.find(part), std::string::npos) << evidence.why_not;
        EXPECT_FALSE(evidence.why_not.empty());
    };
    expect(evidence_on({32, 32}, [&](const auto& i) { return on_object(i) ? 0.6 : inf; }),
           "NaN or infinite");
    expect(evidence_on({32, 32}, [&](const auto& i) { return on_object(i) ? 0.6 : 1.1; }),
           "bright all over");
    expect(evidence_on({40, 30, 3},
                       [](const auto& i) {
                           return std::floor(120.0 +
                                             80.0 * std::sin(0.2 * static_cast<double>(i[0]))) -
                                  20.0 * static_cast<double>(i[2]);
                       }),
           "bright all over");
    expect(evidence_on({100, 4, 4},
                       [](const auto& i) {
                           return i[1] == i[2]            ? 1.0
                                  : i[2] == 3 && i[1] < 3 ? 0.1 * std::sin(i[0])
                                                          : 0.0;
                       }),
           "no more than 4 entries");
    expect(evidence_on({32, 32, 8}, [](const auto& i) { return i[2] == 5 ? 1.0 : 0.0; }),
           "no more than 8 entries");
    expect(evidence_on({64, 32}, [](const auto& i) { return i[0] % 2 == 0 ? 1.0 : -1.0; }),
           "negative");
    expect(evidence_on({64, 32}, [](const auto&) { return 0.0; }), "all values are 0");
}

TEST(LayoutGuess, AListOfASquareNumberOfPointsIsProposedAsAGrid) {
    const TemporaryFolder folder;
    std::vector<double> values;
    for (std::size_t point = 0; point < 144; ++point) {
        for (std::size_t bin = 0; bin < 48; ++bin) values.push_back(light_at(point, 12, bin, 48));
    }
    NpzWriter file(folder.file("a.npz"));
    file.write("counts", {144, 48}, values);
    file.finish();
    const LayoutGuess guess = guess_layout(folder.file("a.npz"));
    EXPECT_EQ(guess.layout["histogram"]["axes"], (core::Json{"s", "t"}));
    CaptureReadSettings settings;
    settings.layout = folder.file("guess.json");
    settings.bin_width_m = 0.01;
    settings.wall_size_m = std::array{1.0, 1.0};
    test_support::write_file_bytes(settings.layout, guess.layout.dump());
    const core::Capture capture = read_capture(folder.file("a.npz"), settings);
    EXPECT_EQ(capture.scan.wall().sensing.grid, (std::array<std::size_t, 2>{12, 12}));
    EXPECT_EQ(capture.time_axis.num_bins, 48);
}

TEST(LayoutGuess, SaysWhyNothingIsProposed) {
    const TemporaryFolder folder;
    NpzWriter file(folder.file("a.npz"));
    file.write("depth", {20, 20}, std::vector<double>(400, std::nan("")));
    file.finish();
    const LayoutGuess guess = guess_layout(folder.file("a.npz"));
    EXPECT_TRUE(guess.layout.is_null());
    ASSERT_EQ(guess.findings.size(), 2U);
    EXPECT_EQ(guess.findings[0],
              "depth (20, 20) is hardly histograms: 400 values are NaN or infinite");
}

}  // namespace
}  // namespace nlos
