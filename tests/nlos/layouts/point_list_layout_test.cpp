// SPDX-License-Identifier: MIT
#include "nlos/formats/capture_file.h"
#include "tests/nlos/formats/mat_writing.h"
#include "tests/support/error_message.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

namespace nlos {
namespace {

/// (horizontal, vertical) indices of a histogram's points.
using Index = std::array<std::uint8_t, 2>;

struct Row {
    Index lit;
    Index seen;
};

constexpr std::size_t kListBins = 4;

/// Point lists in three files; histogram m holds 10 m + bin.
class PointLists {
 public:
    explicit PointLists(const std::vector<Row>& rows, std::uint8_t depth = 0) {
        const std::size_t count = rows.size();
        std::vector<std::uint16_t> signal;
        for (std::size_t bin = 0; bin < kListBins; ++bin) {
            for (std::size_t m = 0; m < count; ++m) {
                signal.push_back(static_cast<std::uint16_t>(10 * m + bin));
            }
        }
        std::vector<std::uint8_t> lit(count, depth);
        std::vector<std::uint8_t> seen(count, 0);
        for (std::size_t axis = 0; axis < 2; ++axis) {
            for (const Row& row : rows) lit.push_back(row.lit[axis]);
            for (const Row& row : rows) seen.push_back(row.seen[axis]);
        }
        write_mat(folder_.file("sub_Sig.mat"),
                  {mat_variable("sub_Sig", {count, kListBins}, signal)});
        write_mat(folder_.file("C_i.mat"), {mat_variable("C_i", {count, 3}, lit)});
        write_mat(folder_.file("C_d.mat"), {mat_variable("C_d", {count, 3}, seen)});
    }

    std::string file(const std::string& name) const { return folder_.file(name); }
    std::string path() const { return folder_.path().string(); }
    core::Capture read() const { return read_capture(path(), settings()); }

    static CaptureReadSettings settings() {
        CaptureReadSettings settings;
        settings.pitch_m = 0.01;
        settings.bin_width_m = 0.0048;
        return settings;
    }

 private:
    test_support::TemporaryFolder folder_;
};

/// A 2 x 3 illumination grid in no order, and one detection point.
std::vector<Row> one_detector() {
    return {{{4, 9}, {7, 7}},
            {{2, 5}, {7, 7}},
            {{4, 5}, {7, 7}},
            {{2, 7}, {7, 7}},
            {{4, 7}, {7, 7}},
            {{2, 9}, {7, 7}}};
}

TEST(PointListCapture, OneDetectorIsAnExhaustiveScanWithOneSensingPoint) {
    const core::Capture capture = PointLists(one_detector()).read();
    EXPECT_EQ(capture.scan.wall().pattern, core::ScanPattern::Exhaustive);
    EXPECT_EQ(capture.scan.wall().illumination.grid, (std::array<std::size_t, 2>{2, 3}));
    ASSERT_EQ(capture.scan.wall().sensing.size(), 1U);
    EXPECT_NEAR(
        (capture.scan.wall().sensing.positions[0] - core::Vec3(0.07, 0.07, 0)).norm(), 0.0, 1e-12);
    // Row 1 of the file is (2, 5), the grid's first point; row 0 is (4, 9), its last.
    EXPECT_NEAR((capture.scan.wall().illumination.positions[0] - core::Vec3(0.02, 0.05, 0)).norm(),
                0,
                1e-12);
    EXPECT_EQ(capture.transient.histogram(0)[3], 13.0F);
    EXPECT_NEAR((capture.scan.wall().illumination.positions[5] - core::Vec3(0.04, 0.09, 0)).norm(),
                0,
                1e-12);
    EXPECT_EQ(capture.transient.histogram(5)[3], 3.0F);
    EXPECT_EQ(capture.time_axis.bin_width_m, 0.0048);
    EXPECT_EQ(capture.unit, core::TransientUnit::Counts);
}

TEST(PointListCapture, PointsInSetupMatAreTakenAsTheyAre) {
    const PointLists lists(one_detector());
    constexpr std::size_t kSide = 3;  // six rows, filled up to nine
    std::vector<double> lit(kSide * kSide * 3, 0.0);
    std::vector<double> seen = lit;
    const std::vector<Row> rows = one_detector();
    for (std::size_t m = 0; m < kSide * kSide; ++m) {
        const Row& row = rows[m < rows.size() ? m : 0];
        for (std::size_t axis = 0; axis < 2; ++axis) {
            // Row after row, in a file whose first index is the fastest.
            const std::size_t place = m / kSide + kSide * (m % kSide) + kSide * kSide * axis;
            lit[place] = 0.02 * row.lit[axis];
            seen[place] = 0.02 * row.seen[axis];
        }
    }
    write_mat(lists.file("setup.mat"),
              {mat_variable("laserpoints", {kSide, kSide, 3}, lit),
               mat_variable("detectpoints", {kSide, kSide, 3}, seen)});
    CaptureReadSettings settings;
    settings.bin_width_m = 0.0048;
    const core::Capture capture = read_capture(lists.path(), settings);
    const core::WallScan& scan = capture.scan.wall();
    EXPECT_EQ(scan.illumination.grid, (std::array<std::size_t, 2>{2, 3}));
    EXPECT_NEAR((scan.illumination.positions[0] - core::Vec3(0.04, 0.1, 0)).norm(), 0, 1e-12);
    EXPECT_NEAR((scan.sensing.positions[0] - core::Vec3(0.14, 0.14, 0)).norm(), 0, 1e-12);
    EXPECT_EQ(capture.transient.histogram(0)[3], 13.0F);
}

TEST(PointListCapture, OneIlluminationPointIsASingleScan) {
    std::vector<Row> rows = one_detector();
    for (Row& row : rows) std::swap(row.lit, row.seen);
    const core::Capture capture = PointLists(rows).read();
    EXPECT_EQ(capture.scan.wall().pattern, core::ScanPattern::Single);
    EXPECT_EQ(capture.transient.histogram(0)[3], 13.0F);
}

TEST(PointListCapture, AllPairsAreAnExhaustiveScan) {
    const core::Capture capture =
        PointLists({{{1, 1}, {8, 8}}, {{1, 1}, {9, 8}}, {{2, 1}, {9, 8}}, {{2, 1}, {8, 8}}}).read();
    EXPECT_EQ(capture.scan.wall().pattern, core::ScanPattern::Exhaustive);
    EXPECT_EQ(capture.scan.num_pairs(), 4U);
    EXPECT_EQ(capture.transient.histogram(2)[0], 30.0F);  // second illumination, first sensing
}

TEST(PointListCapture, SamePointsAreAConfocalScan) {
    const core::Capture capture = PointLists({{{3, 1}, {3, 1}}, {{1, 2}, {1, 2}}}).read();
    EXPECT_EQ(capture.scan.wall().pattern, core::ScanPattern::Confocal);
    EXPECT_FALSE(capture.scan.wall().sensing.grid);
    EXPECT_EQ(capture.transient.histogram(1)[1], 11.0F);
}

TEST(PointListCapture, TheFolderAndTheSignalFileReadTheSame) {
    const PointLists lists(one_detector());
    const core::Capture a = lists.read();
    const core::Capture b = read_capture(lists.file("sub_Sig.mat"), PointLists::settings());
    EXPECT_TRUE(std::ranges::equal(a.transient.values(), b.transient.values()));
    EXPECT_EQ(capture_format(lists.path()), "general-NLOS point lists .mat");
}

TEST(PointListCapture, AsksForTheSettingsItNeeds) {
    const PointLists lists(one_detector());
    CaptureReadSettings settings;
    EXPECT_EQ(missing_settings(lists.path(), settings).size(), 2U);
    EXPECT_ERROR_WITH(read_capture(lists.path(), settings), "--set capture.pitch_m=");
    settings.pitch_m = 0.01;
    EXPECT_ERROR_WITH(read_capture(lists.path(), settings), "--set capture.bin_width_m=");
    settings.bin_width_m = -1.0;
    EXPECT_ERROR_WITH(read_capture(lists.path(), settings), "capture.bin_width_m: found -1");
}

TEST(PointListCapture, RefusesPairsThatAreNoScan) {
    EXPECT_ERROR_WITH(PointLists({{{1, 1}, {8, 8}}, {{2, 1}, {9, 8}}}).read(),
                      "has 2 histograms for 4 pairs of points");
    EXPECT_ERROR_WITH(
        PointLists({{{1, 1}, {8, 8}}, {{1, 1}, {8, 8}}, {{2, 1}, {9, 8}}, {{2, 1}, {8, 8}}}).read(),
        "histogram 1 repeats");
}

TEST(PointListCapture, DepthIndicesAreAlongZ) {
    const core::Capture capture = PointLists(one_detector(), 3).read();
    EXPECT_NEAR(capture.scan.wall().illumination.positions[0].z(), 0.03, 1e-12);
    EXPECT_NEAR(capture.scan.wall().sensing.positions[0].z(), 0.0, 1e-12);
}

TEST(PointListCapture, NamesTheFileThatIsMissingOrWrong) {
    const PointLists lists(one_detector());
    std::filesystem::remove(lists.file("C_d.mat"));
    EXPECT_ERROR_WITH(read_capture(lists.file("sub_Sig.mat"), PointLists::settings()),
                      "no array C_d.mat:C_d");
    const std::vector<std::uint8_t> few(6, 1);
    write_mat(lists.file("C_d.mat"), {mat_variable("C_d", {2, 3}, few)});
    EXPECT_ERROR_WITH(lists.read(),
                      "C_d: has shape (2, 3); must hold three coordinates for each of 6 points");
}

}  // namespace
}  // namespace nlos
