// SPDX-License-Identifier: MIT
#include "nlos/formats/capture_file.h"
#include "tests/nlos/formats/mat_writing.h"
#include "tests/support/error_message.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

namespace nlos {
namespace {

using test_support::TemporaryFolder;

constexpr std::size_t kSide = 3;
constexpr std::size_t kFileBins = 700;

/// rect_data(i, j, t) of the files made here.
std::uint16_t stanford_value(std::size_t i, std::size_t j, std::size_t bin) {
    return static_cast<std::uint16_t>(1000 * i + 10000 * j + bin);
}

std::vector<std::uint16_t> example_data() {
    std::vector<std::uint16_t> data;
    for (std::size_t bin = 0; bin < kFileBins; ++bin) {
        for (std::size_t j = 0; j < kSide; ++j) {
            for (std::size_t i = 0; i < kSide; ++i) data.push_back(stanford_value(i, j, bin));
        }
    }
    return data;
}

class StanfordFile {
 public:
    StanfordFile() : StanfordFile({kSide, kSide, kFileBins}, {0.4}) {}
    StanfordFile(std::vector<std::size_t> shape,
                 const std::vector<double>& width,
                 matio_compression compression = MAT_COMPRESSION_ZLIB)
        : path_(folder_.file("data.mat")) {
        std::vector<std::uint16_t> data = example_data();
        write_mat(path_,
                  {mat_variable("rect_data", std::move(shape), data),
                   mat_variable("width", {width.size(), 1}, width)},
                  compression);
    }
    const std::string& path() const { return path_; }
    core::Capture read() const { return read_capture(path_); }

 private:
    TemporaryFolder folder_;
    std::string path_;
};

TEST(StanfordCapture, PointsFollowTheAxesOfTheFile) {
    const core::Capture capture = StanfordFile().read();
    EXPECT_EQ(capture.scan.wall().pattern, core::ScanPattern::Confocal);
    EXPECT_EQ(capture.scan.wall().opl_origin, core::OplOrigin::RelayWall);
    const auto& points = capture.scan.wall().sensing;
    EXPECT_EQ(points.grid, (std::array<std::size_t, 2>{kSide, kSide}));
    EXPECT_NEAR((points.positions[0] - core::Vec3(-0.4, 0.4, 0.0)).norm(), 0.0, 1e-12);
    EXPECT_NEAR((points.positions[1] - core::Vec3(-0.4, 0.0, 0.0)).norm(), 0.0, 1e-12);
    EXPECT_NEAR((points.positions[kSide] - core::Vec3(0.0, 0.4, 0.0)).norm(), 0.0, 1e-12);
    EXPECT_NEAR((points.positions[8] - core::Vec3(0.4, -0.4, 0.0)).norm(), 0.0, 1e-12);
    EXPECT_EQ(points.normals[5], core::Vec3::UnitZ());
}

TEST(StanfordCapture, BinsAreFourPicosecondsWithTheDirectReturnInTheFirst) {
    const core::Capture capture = StanfordFile().read();
    EXPECT_EQ(capture.unit, core::TransientUnit::Counts);
    EXPECT_EQ(capture.time_axis.num_bins, static_cast<int>(kFileBins));
    EXPECT_NEAR(capture.time_axis.bin_width_m, 4e-12 * 299792458.0, 1e-15);
    EXPECT_NEAR(capture.time_axis.bin_center_m(0), 0.0, 1e-15);
}

TEST(StanfordCapture, TheTailOfTheDirectReturnIsZeroedUnlessAskedOtherwise) {
    const StanfordFile file;
    const core::Capture capture = file.read();
    const auto histogram = capture.transient.histogram(1 * kSide + 2);
    EXPECT_EQ(histogram[599], 0.0F);
    EXPECT_EQ(histogram[600], static_cast<float>(stanford_value(1, 2, 600)));
    EXPECT_EQ(histogram[699], static_cast<float>(stanford_value(1, 2, 699)));
    std::string notes;
    for (const auto& note : capture.notes) notes += note;
    EXPECT_NE(notes.find("first 600 bins"), std::string::npos);

    CaptureReadSettings settings;
    settings.zero_bins = 0;
    const core::Capture whole = read_capture(file.path(), settings);
    EXPECT_EQ(whole.transient.histogram(7)[5], static_cast<float>(stanford_value(2, 1, 5)));
}

TEST(StanfordCapture, UncompressedFilesReadTheSame) {
    const core::Capture a = StanfordFile().read();
    const core::Capture b =
        StanfordFile({kSide, kSide, kFileBins}, {0.4}, MAT_COMPRESSION_NONE).read();
    EXPECT_TRUE(std::ranges::equal(a.transient.values(), b.transient.values()));
}

TEST(StanfordCapture, WrongShapesAndWidthsAreNamed) {
    EXPECT_ERROR_WITH(StanfordFile({kSide, 2, 2}, {0.4}).read(),
                      "no array rect_data with axes (x, y, t) and x as long as y");
    EXPECT_ERROR_WITH(StanfordFile({4, 4}, {0.4}).read(), "rect_data has shape (4, 4)");
    EXPECT_ERROR_WITH(StanfordFile({3, 3, 9}, {0.4, 0.5}).read(), "width has shape (2, 1)");
    EXPECT_ERROR_WITH(StanfordFile({3, 3, 9}, {-1.0}).read(), "must be a positive number");
    EXPECT_ERROR_WITH(StanfordFile({3, 3, 9}, {std::nan("")}).read(), "width: found nan");
}

TEST(StanfordCapture, AFileWithoutWidthIsNamed) {
    const TemporaryFolder folder;
    const auto data = example_data();
    write_mat(folder.file("a.mat"), {mat_variable("rect_data", {kSide, kSide, kFileBins}, data)});
    EXPECT_ERROR_WITH(read_capture(folder.file("a.mat")), "stanford-2018: no array width");
    write_mat(folder.file("b.mat"), {mat_variable("other", {kSide, kSide, kFileBins}, data)});
    EXPECT_ERROR_WITH(read_capture(folder.file("b.mat")), "is no capture in a known format");
}

TEST(StanfordCapture, EveryTruncationIsReported) {
    for (const auto compression : {MAT_COMPRESSION_ZLIB, MAT_COMPRESSION_NONE}) {
        const StanfordFile file({kSide, kSide, kFileBins}, {0.4}, compression);
        const std::string bytes = test_support::file_bytes(file.path());
        for (std::size_t length = 0; length < bytes.size(); length += 1 + bytes.size() / 101) {
            test_support::write_file_bytes(file.path(), bytes.substr(0, length));
            EXPECT_ERROR_WITH(file.read(), file.path()) << length;
        }
    }
}

}  // namespace
}  // namespace nlos
