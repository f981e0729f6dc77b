// SPDX-License-Identifier: MIT
#include "nlos/layouts/layout.h"

#include "nlos/containers/writers/npz_writer.h"
#include "nlos/formats/capture_file.h"
#include "nlos/layouts/layout_guess.h"
#include "nlos/layouts/layout_points.h"
#include "renderer/core/capture/recorded_detector.h"
#include "renderer/core/settings/json_file.h"
#include "tests/nlos/formats/mat_writing.h"
#include "tests/support/error_message.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace nlos {
namespace {

using core::Json;
using test_support::TemporaryFolder;

constexpr std::size_t kCubeColumns = 2;
constexpr std::size_t kCubeRows = 3;
constexpr std::size_t kCubeBins = 5;

double cube_value(std::size_t x, std::size_t y, std::size_t t) {
    return 1.0 + static_cast<double>(100 * x + 10 * y + t);
}

/// H with its axes in the order of `axes`, the first fastest as in MATLAB.
std::vector<double> histograms(const std::vector<std::string>& axes,
                               std::vector<std::size_t>& shape) {
    const auto extent = [](const std::string& axis) {
        return axis == "x" ? kCubeColumns : axis == "y" ? kCubeRows : kCubeBins;
    };
    shape.clear();
    for (const std::string& axis : axes) shape.push_back(extent(axis));
    std::vector<double> values;
    for (std::size_t c = 0; c < shape[2]; ++c) {
        for (std::size_t b = 0; b < shape[1]; ++b) {
            for (std::size_t a = 0; a < shape[0]; ++a) {
                const std::array<std::size_t, 3> index{a, b, c};
                std::array<std::size_t, 3> xyt{};
                for (std::size_t i = 0; i < 3; ++i) {
                    xyt[axes[i] == "x" ? 0 : axes[i] == "y" ? 1 : 2] = index[i];
                }
                values.push_back(cube_value(xyt[0], xyt[1], xyt[2]));
            }
        }
    }
    return values;
}

Json confocal_layout(const std::vector<std::string>& axes) {
    Json layout;
    layout["name"] = "test";
    layout["histogram"] = {{"array", {"cube"}}, {"axes", axes}};
    layout["bins"] = {{"width_m", 0.01}, {"start_m", 0.5}};
    layout["sensing"]["grid"] = {{"size_m", {1.0, 2.0}}, {"y", "decreasing"}};
    return layout;
}

/// A MATLAB file with one cube and a layout for it.
class LaidOut {
 public:
    explicit LaidOut(const std::vector<std::string>& axes) : layout(confocal_layout(axes)) {
        std::vector<std::size_t> shape;
        cube = histograms(axes, shape);
        write_mat(file(), {mat_variable("cube", shape, cube)});
    }
    std::string file() const { return folder_.file("cube.mat"); }
    CaptureReadSettings settings() const {
        test_support::write_file_bytes(folder_.file("my.json"), layout.dump());
        CaptureReadSettings settings;
        settings.layout = folder_.file("my.json");
        return settings;
    }
    core::Capture read() const { return read_capture(file(), settings()); }
    std::string beside(const std::string& name) const { return folder_.file(name); }

    Json layout;
    std::vector<double> cube;

 private:
    TemporaryFolder folder_;
};

TEST(Layouts, ShippedOnesHaveNamesOfTheirOwn) {
    std::set<std::string> names;
    for (const Layout& layout : shipped_layouts()) {
        EXPECT_TRUE(names.insert(layout.name).second) << layout.name;
        EXPECT_FALSE(layout.title.empty()) << layout.name;
    }
    EXPECT_GE(names.size(), 20U);
}

TEST(Layouts, AxesMayStandInAnyOrder) {
    std::vector<std::string> axes{"t", "x", "y"};
    do {
        const LaidOut example(axes);
        const core::Capture capture = example.read();
        EXPECT_EQ(capture.scan.wall().sensing.grid,
                  (std::array<std::size_t, 2>{kCubeColumns, kCubeRows}));
        for (std::size_t x = 0; x < kCubeColumns; ++x) {
            for (std::size_t y = 0; y < kCubeRows; ++y) {
                const std::size_t pair = x * kCubeRows + y;
                for (std::size_t t = 0; t < kCubeBins; ++t) {
                    EXPECT_EQ(capture.transient.histogram(pair)[t], cube_value(x, y, t));
                }
                const core::Vec3 position(
                    -0.5 + static_cast<double>(x), 1.0 - static_cast<double>(y), 0.0);
                EXPECT_LT((capture.scan.wall().sensing.positions[pair] - position).norm(), 1e-12);
            }
        }
    } while (std::next_permutation(axes.begin(), axes.end()));
}

TEST(Layouts, AxesThatAreNotNamedAreSummed) {
    LaidOut example({"x", "y", "t"});
    example.layout["histogram"]["axes"] = {"x", "colour", "t"};
    example.layout["sensing"] = {{"x", "px"}, {"y", "px"}};
    const std::vector<double> px{0.0, 1.0};
    write_mat(example.file(),
              {mat_variable("cube", {kCubeColumns, kCubeRows, kCubeBins}, example.cube),
               mat_variable("px", {2, 1}, px)});
    example.layout["histogram"]["axes"] = {"s", "colour", "t"};
    const core::Capture capture = example.read();
    ASSERT_EQ(capture.scan.num_pairs(), kCubeColumns);
    EXPECT_EQ(capture.transient.histogram(1)[2],
              cube_value(1, 0, 2) + cube_value(1, 1, 2) + cube_value(1, 2, 2));
}

TEST(Layouts, DelaysAreTakenOffAndLeaveBinsUnobserved) {
    LaidOut example({"y", "x", "t"});
    const std::vector<double> delays_ps{0.0, 33.0, 64.0, -1.0, 0.0, 0.0};  // y fastest
    write_mat(example.beside("tof.mat"),
              {mat_variable("grid", {kCubeRows, kCubeColumns}, delays_ps)});
    example.layout["bins"]["shift"] = {
        {"array", "tof.mat:grid"}, {"axes", {"y", "x"}}, {"bins_per_unit", 1.0 / 32.0}};
    const core::Capture capture = example.read();
    EXPECT_EQ(capture.transient.histogram(0)[0], cube_value(0, 0, 0));
    EXPECT_EQ(capture.transient.histogram(1)[0], cube_value(0, 1, 1));
    EXPECT_EQ(capture.transient.histogram(2)[0], cube_value(0, 2, 2));
    EXPECT_EQ(capture.transient.histogram(3)[1], cube_value(1, 0, 0));  // rounded down to -1 bin
    const auto range = [&](std::size_t pair) {
        const core::BinRange r = capture.observed_range(pair);
        return std::array{r.begin, r.end};
    };
    EXPECT_EQ(range(0), (std::array{0, 5}));
    EXPECT_EQ(range(1), (std::array{0, 4}));
    EXPECT_EQ(range(2), (std::array{0, 3}));
    EXPECT_EQ(range(3), (std::array{1, 5}));
}

TEST(Layouts, AGateOfZerosIsUnobserved) {
    LaidOut example({"x", "y", "t"});
    for (std::size_t i = 0; i < kCubeColumns * kCubeRows; ++i) example.cube[i] = 0.0;  // bin 0
    write_mat(example.file(),
              {mat_variable("cube", {kCubeColumns, kCubeRows, kCubeBins}, example.cube)});
    example.layout["bins"]["zeros_are_unobserved"] = true;
    const core::Capture capture = example.read();
    EXPECT_EQ(capture.observed_range(4).begin, 1);
    EXPECT_EQ(capture.observed_range(4).end, 5);
}

TEST(Layouts, FramesAreKeptOrChosen) {
    LaidOut example({"x", "y", "t"});
    example.layout["histogram"]["axes"] = {"frame", "y", "t"};
    example.layout["histogram"]["axes"] = {"frame", "s", "t"};
    example.layout["sensing"] = {{"x", "px"}, {"y", "px"}};
    const std::vector<double> px{0.0, 1.0, 2.0};
    write_mat(example.file(),
              {mat_variable("cube", {kCubeColumns, kCubeRows, kCubeBins}, example.cube),
               mat_variable("px", {3, 1}, px)});
    const core::Capture capture = example.read();
    ASSERT_TRUE(capture.sequence);
    ASSERT_EQ(capture.sequence->frames.size(), kCubeColumns);
    EXPECT_EQ(capture.sequence->frames[0].histogram(2)[3], cube_value(0, 2, 3));
    EXPECT_EQ(capture.transient.histogram(2)[3], cube_value(1, 2, 3));
    CaptureReadSettings settings = example.settings();
    settings.frame = 0;
    const core::Capture first = read_capture(example.file(), settings);
    EXPECT_FALSE(first.sequence);
    EXPECT_EQ(first.transient.histogram(2)[3], cube_value(0, 2, 3));
    settings.frame = 2;
    EXPECT_ERROR_WITH(read_capture(example.file(), settings), "capture.frame: found 2");
}

/// A frame of layout st-vl53l8, four zones of six bins that all hold `value` from one on.
void write_zones(const std::string& path, double value, std::size_t first_bin = 0) {
    NpzWriter file(path);
    std::vector<double> values(24, value);
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (i % 6 < first_bin) values[i] = 0.0;
    }
    const std::vector<double> points{0, 0, 1, 0, 1, 1, 1, 0, 1, 1, 1, 1};
    file.write("hists", {4, 6}, values);
    file.write("pt_cloud", {4, 3}, points);
    file.finish();
}

TEST(Layouts, SeveralFilesAreFramesInTheOrderGiven) {
    const TemporaryFolder folder;
    write_zones(folder.file("a.npz"), 3.0);
    write_zones(folder.file("b.npz"), 5.0);
    const std::vector<std::string> files{folder.file("b.npz"), folder.file("a.npz")};
    const core::Capture capture = read_capture(files);
    ASSERT_TRUE(capture.sequence);
    ASSERT_EQ(capture.sequence->frames.size(), 2U);
    EXPECT_EQ(capture.sequence->frames[0].histogram(2)[4], 5.0F);
    EXPECT_EQ(capture.sequence->frames[1].histogram(2)[4], 3.0F);
    CaptureReadSettings settings;
    settings.frame = 0;
    EXPECT_EQ(read_capture(files, settings).transient.histogram(1)[0], 5.0F);
}

TEST(Layouts, FramesOfAMovingSensorHaveTheirOwnObservedBins) {
    const TemporaryFolder folder;
    write_zones(folder.file("a.npz"), 3.0, 2);
    write_zones(folder.file("b.npz"), 5.0, 1);
    write_zones(folder.file("c.npz"), 5.0, 3);
    const core::Capture capture = read_capture(folder.path().string());
    ASSERT_TRUE(capture.sequence);
    EXPECT_EQ(capture.observed_range(2), (core::BinRange{3, 6}));
    for (const auto& [frame, first] : {std::pair(0, 2), std::pair(1, 1), std::pair(2, 3)}) {
        EXPECT_EQ((*capture.observed_in_frame(static_cast<std::size_t>(frame)))[2],
                  (core::BinRange{first, 6}));
    }
    EXPECT_TRUE(capture.sequence->frames[0].histogram(1)[2] == 3.0F);
}

TEST(Layouts, SeveralFilesThatAreNoFramesAreRefused) {
    LaidOut example({"x", "y", "t"});
    EXPECT_ERROR_WITH(read_capture(std::vector{example.file(), example.file()}, example.settings()),
                      "is the first of 2 files of layout test; must stand alone");
    const TemporaryFolder folder;
    write_zones(folder.file("a.npz"), 3.0);
    EXPECT_ERROR_WITH(read_capture(std::vector{folder.file("a.npz"), example.file()}),
                      "is not of layout st-vl53l8; must be, as the frames before");
    EXPECT_ERROR_WITH(read_capture(std::vector{folder.file("a.npz"), folder.file("none.npz")}),
                      "none.npz: does not exist");
}

TEST(Layouts, NumbersComeFromArraysStepsAndPeaks) {
    LaidOut example({"x", "y", "t"});
    const std::vector<double> times{3.0, 5.0, 7.0, 9.0, 11.0};
    const std::vector<double> direct{0.0, 4.0, 9.0, 1.0, 0.0};
    write_mat(example.file(),
              {mat_variable("cube", {kCubeColumns, kCubeRows, kCubeBins}, example.cube),
               mat_variable("times", {5, 1}, times),
               mat_variable("direct", {5, 1}, direct)});
    example.layout["bins"] = {
        {"width_m", {{"step_of", "times"}, {"factor", 0.01}}},
        {"start_bins", {{"peak_of", "direct"}, {"factor", -1}, {"offset", -0.5}}}};
    const core::Capture capture = example.read();
    EXPECT_NEAR(capture.time_axis.bin_width_m, 0.02, 1e-15);
    EXPECT_NEAR(capture.time_axis.bin_center_m(2), 0.0, 1e-15);
}

TEST(Layouts, ResponseAndSpotGoToTheProvenance) {
    LaidOut example({"x", "y", "t"});
    example.layout["response_fwhm_s"] = {{"array", "jitter"}, {"factor", 1e-12}};
    example.layout["spot_fwhm_m"] = {{"array", "radius"}, {"factor", 2.0}};
    EXPECT_FALSE(core::recorded_response(example.read()));
    EXPECT_FALSE(core::recorded_spot_m(example.read()));
    write_mat(example.file(),
              {mat_variable("cube", {kCubeColumns, kCubeRows, kCubeBins}, example.cube),
               mat_variable("jitter", {1, 1}, std::vector<double>{800.0}),
               mat_variable("radius", {1, 1}, std::vector<double>{0.07})});
    EXPECT_NEAR(core::recorded_response(example.read())->jitter_fwhm_ps, 800.0, 1e-9);
    EXPECT_NEAR(core::recorded_spot_m(example.read()).value_or(0.0), 0.14, 1e-12);
}

TEST(Layouts, WhatTheFileLacksIsAskedFor) {
    LaidOut example({"x", "y", "t"});
    example.layout["bins"] = {{"width_m", {{"ask", "0.0012 for 4 ps"}}}};
    CaptureReadSettings settings = example.settings();
    EXPECT_EQ(missing_settings(example.file(), settings),
              std::vector<std::string>{"capture.bin_width_m=... (0.0012 for 4 ps)"});
    EXPECT_ERROR_WITH(read_capture(example.file(), settings),
                      "must be given as --set capture.bin_width_m=... (0.0012 for 4 ps)");
    settings.bin_width_m = 0.0012;
    EXPECT_TRUE(missing_settings(example.file(), settings).empty());
    EXPECT_EQ(read_capture(example.file(), settings).time_axis.bin_width_m, 0.0012);
}

TEST(Layouts, MistakesInALayoutAreNamed) {
    LaidOut example({"x", "y", "t"});
    const Json good = example.layout;
    const auto with = [&](const char* key, const Json& value) {
        example.layout = good;
        example.layout[Json::json_pointer(key)] = value;
        return example.settings();
    };
    const auto read = [&](const CaptureReadSettings& s) { return read_capture(example.file(), s); };
    EXPECT_ERROR_WITH(read(with("/histogramm", 1)), "histogramm");
    EXPECT_ERROR_WITH(read(with("/bins/width_s", 1e-12)), "bins: found no or two widths");
    EXPECT_ERROR_WITH(read(with("/histogram/axes", Json{"x", "y", "z"})), "0 axes named t");
    EXPECT_ERROR_WITH(read(with("/histogram/array", Json{"other"})), "no array other");
    EXPECT_ERROR_WITH(read(with("/sensing/grid/size_m", Json{{{"array", "gone"}}})),
                      "gone: is missing");
    EXPECT_ERROR_WITH(read(with("/sensing/array", "a")), "2 ways to say where the points are");
    EXPECT_ERROR_WITH(read(with("/pattern", "spiral")), "single|confocal|exhaustive|by_points");
    CaptureReadSettings unknown;
    unknown.layout = "no-such-layout";
    EXPECT_ERROR_WITH(read(unknown), "stanford-fk-2019");
}

TEST(Layouts, AnUnknownFileIsDescribedAndItsGuessReads) {
    const TemporaryFolder folder;
    // Light arrives late along the first axis; a bin width in seconds and a size are there.
    constexpr std::size_t kTimes = 64;
    constexpr std::size_t kSide = 8;
    std::vector<double> odd(kTimes * kSide * kSide, 0.0);
    for (std::size_t point = 0; point < kSide * kSide; ++point) {
        odd[point * kTimes + 20 + point % 5] = 10.0;
    }
    const std::vector<double> width{16e-12};
    const std::vector<double> size{0.7};
    const std::string file = folder.file("odd.mat");
    write_mat(file,
              {mat_variable("odd", {kTimes, kSide, kSide}, odd),
               mat_variable("bin_resolution", {1, 1}, width),
               mat_variable("wall_size", {1, 1}, size)});
    EXPECT_ERROR_WITH(read_capture(file), "lists its arrays; the nearest layout is");
    const LayoutGuess guess = guess_layout(file);
    EXPECT_EQ(guess.arrays.size(), 3U);
    EXPECT_FALSE(guess.nearest.empty());
    EXPECT_EQ(guess.layout["histogram"]["axes"][0], "t");
    CaptureReadSettings settings;
    settings.layout = folder.file("guess.json");
    test_support::write_file_bytes(settings.layout, guess.layout.dump());
    const core::Capture capture = read_capture(file, settings);
    EXPECT_NEAR(capture.time_axis.bin_width_m, 16e-12 * 299792458.0, 1e-12);
    EXPECT_EQ(capture.scan.num_pairs(), kSide * kSide);
    EXPECT_NEAR(capture.scan.wall().sensing.positions.back().x(), 0.35, 1e-12);
}

TEST(Layouts, NormalsThatAreNotThereFollowFromThePoints) {
    std::vector<core::Vec3> plane;
    std::vector<core::Vec3> cylinder;
    for (int i = 0; i < 12; ++i) {
        for (int j = 0; j < 12; ++j) {
            plane.emplace_back(0.1 * i, 0.1 * j, 0.3 * 0.1 * i);
            const double angle = 0.1 * i;
            cylinder.emplace_back(std::sin(angle), 0.1 * j, std::cos(angle));
        }
    }
    const core::Vec3 tilted = core::Vec3(-0.3, 0.0, 1.0).normalized();
    for (const core::Vec3& n : fitted_normals(plane, std::nullopt)) {
        EXPECT_LT((n - tilted).norm(), 1e-9);
    }
    const core::Vec3 axis(0.0, 0.5, 0.0);  // inside: normals look inwards
    const auto normals = fitted_normals(cylinder, axis);
    for (std::size_t i = 0; i < normals.size(); ++i) {
        const core::Vec3 inwards = -core::Vec3(cylinder[i].x(), 0.0, cylinder[i].z());
        EXPECT_GT(normals[i].dot(inwards), 0.98);
    }
}

}  // namespace
}  // namespace nlos
