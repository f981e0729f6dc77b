// SPDX-License-Identifier: MIT
// What stands in files written as stanford-fk-2019 and conv-nlos, read by HDF5 and matio
// themselves.
#include "nlos/formats/capture_file.h"
#include "tests/support/error_message.h"
#include "tests/support/example_capture.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>
#include <hdf5.h>
#include <matio.h>

#include <algorithm>
#include <memory>

namespace nlos {
namespace {

using core::Capture;
using core::ScanPattern;
using test_support::example_capture;
using test_support::example_square;
using test_support::TemporaryFolder;

std::vector<std::string> write_as(const std::string& layout,
                                  const std::string& path,
                                  const Capture& capture) {
    CaptureWriteSettings settings;
    settings.layout = layout;
    return write_capture(path, capture, settings);
}

/// A dataset of an HDF5 file.
struct Dataset {
    std::vector<hsize_t> shape;
    std::vector<double> values;
    std::string matlab_class;
};

Dataset read_dataset(hid_t file, const char* name) {
    Dataset read;
    const hid_t set = H5Dopen2(file, name, H5P_DEFAULT);
    EXPECT_GE(set, 0) << name;
    const hid_t space = H5Dget_space(set);
    read.shape.resize(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
    H5Sget_simple_extent_dims(space, read.shape.data(), nullptr);
    read.values.resize(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, read.values.data());
    const hid_t attribute = H5Aopen(set, "MATLAB_class", H5P_DEFAULT);
    EXPECT_GE(attribute, 0) << name;
    const hid_t type = H5Aget_type(attribute);
    EXPECT_EQ(H5Tis_variable_str(type), 0);
    read.matlab_class.resize(H5Tget_size(type));
    H5Aread(attribute, type, read.matlab_class.data());
    H5Tclose(type);
    H5Aclose(attribute);
    H5Sclose(space);
    H5Dclose(set);
    return read;
}

TEST(StanfordFkWriter, StartsWithTheHeaderOfMatlab73) {
    const TemporaryFolder folder;
    write_as("stanford-fk-2019", folder.file("a.mat"), example_square());
    const std::string bytes = test_support::file_bytes(folder.file("a.mat"));
    EXPECT_EQ(bytes.substr(0, 20), "MATLAB 7.3 MAT-file,");
    EXPECT_EQ(bytes.substr(0, 116).find_last_not_of(' ') < 116, true);
    EXPECT_EQ(bytes.substr(124, 4), std::string("\x00\x02IM", 4));
    EXPECT_EQ(bytes.substr(128, 384), std::string(384, '\0'));
    EXPECT_EQ(bytes.substr(512, 8), "\x89HDF\r\n\x1a\n");
}

TEST(StanfordFkWriter, MeasIsYThenXThenTimeForMatlab) {
    const TemporaryFolder folder;
    Capture capture = example_square();
    capture.unit = core::TransientUnit::Counts;
    capture.counts_per_radiance = 77.5;
    EXPECT_EQ(write_as("stanford-fk-2019", folder.file("a.mat"), capture).size(), 1U);
    const hid_t file = H5Fopen(folder.file("a.mat").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    ASSERT_GE(file, 0);
    H5G_info_t root;
    H5Gget_info(file, &root);
    EXPECT_EQ(root.nlinks, 3U);
    const Dataset meas = read_dataset(file, "meas");
    EXPECT_EQ(meas.matlab_class, "single");
    EXPECT_EQ(meas.shape, (std::vector<hsize_t>{4, 3, 3}));  // MATLAB counts the other way round
    for (std::size_t bin = 0; bin < 4; ++bin) {
        for (std::size_t x = 0; x < 3; ++x) {
            for (std::size_t row = 0; row < 3; ++row) {
                const std::size_t y = 2 - row;  // the first row is the top one
                EXPECT_EQ(meas.values[(bin * 3 + x) * 3 + row],
                          capture.transient.histogram(x * 3 + y)[bin]);
            }
        }
    }
    const Dataset axis = read_dataset(file, "nlos_axis");
    EXPECT_EQ(axis.matlab_class, "double");
    EXPECT_EQ(axis.shape, (std::vector<hsize_t>{4, 1}));
    EXPECT_EQ(axis.values, (std::vector<double>{0.125, 0.0047, 1.0, 77.5}));
    const Dataset width = read_dataset(file, "nlos_width");
    EXPECT_EQ(width.shape, (std::vector<hsize_t>{2, 1}));
    EXPECT_EQ(width.values, (std::vector<double>{0.4, 0.4}));
    H5Fclose(file);
}

TEST(StanfordFkWriter, RefusesWhatIsNoSquare) {
    const TemporaryFolder folder;
    const auto expect = [&](const Capture& capture, const std::string& part) {
        EXPECT_ERROR_WITH(write_as("stanford-fk-2019", folder.file("a.mat"), capture), part);
        EXPECT_FALSE(std::filesystem::exists(folder.file("a.mat")));
    };
    expect(example_capture(ScanPattern::Exhaustive), "exhaustive");
    expect(example_capture(ScanPattern::Confocal), "square");
    expect(test_support::example_image(), "camera");
    Capture capture = example_square();
    capture.scan.wall().opl_origin = core::OplOrigin::Device;
    expect(capture, "device segments");
}

TEST(StanfordFkWriter, NamesWhatIsLeftOut) {
    const TemporaryFolder folder;
    Capture capture = example_square();
    capture.variance = capture.transient;
    capture.scene_info["seed"] = 7;
    for (const char* layout : {"stanford-fk-2019", "conv-nlos"}) {
        const auto losses = write_as(layout, folder.file("a.mat"), capture);
        ASSERT_GE(losses.size(), 2U);
        EXPECT_EQ(losses.back(), "the file has no place for variance, scene_info");
    }
}

/// The struct NLOSDATA of a file.
class NlosData {
 public:
    explicit NlosData(const std::string& path)
        : file_(Mat_Open(path.c_str(), MAT_ACC_RDONLY), Mat_Close),
          data_(Mat_VarRead(file_.get(), "NLOSDATA"), Mat_VarFree) {}

    std::size_t num_fields() const { return Mat_VarGetNumberOfFields(data_.get()); }
    std::vector<std::size_t> shape(const char* name) const {
        const matvar_t& field = find(name);
        return {field.dims, field.dims + field.rank};
    }
    std::vector<double> values(const char* name) const {
        const matvar_t& field = find(name);
        EXPECT_EQ(field.class_type, MAT_C_DOUBLE) << name;
        const auto* begin = static_cast<const double*>(field.data);
        return {begin, begin + field.nbytes / sizeof(double)};
    }

 private:
    const matvar_t& find(const char* name) const {
        return *Mat_VarGetStructFieldByName(data_.get(), name, 0);
    }

    std::unique_ptr<mat_t, int (*)(mat_t*)> file_;
    std::unique_ptr<matvar_t, void (*)(matvar_t*)> data_;
};

TEST(ConvNlosWriter, ConfocalTransientsAreXThenYThenTime) {
    const TemporaryFolder folder;
    const Capture capture = example_capture(ScanPattern::Confocal);
    write_as("conv-nlos", folder.file("a.mat"), capture);
    const NlosData data(folder.file("a.mat"));
    EXPECT_EQ(data.num_fields(), 7U);
    EXPECT_EQ(data.shape("transient"), (std::vector<std::size_t>{3, 2, 5}));
    EXPECT_EQ(data.values("is_confocal"), std::vector<double>{1.0});
    const auto transient = data.values("transient");
    for (std::size_t x = 0; x < 3; ++x) {
        for (std::size_t y = 0; y < 2; ++y) {
            for (std::size_t bin = 0; bin < 5; ++bin) {
                EXPECT_EQ(transient[x + 3 * (y + 2 * bin)],
                          capture.transient.histogram(2 * x + y)[bin]);
            }
        }
    }
    EXPECT_EQ(data.shape("l"), (std::vector<std::size_t>{6, 3}));
    EXPECT_EQ(data.values("l"), data.values("s"));
}

TEST(ConvNlosWriter, TheWallStandsAtTheTargetDistance) {
    const TemporaryFolder folder;
    const Capture capture = example_capture(ScanPattern::Confocal);
    write_as("conv-nlos", folder.file("a.mat"), capture);
    const NlosData data(folder.file("a.mat"));
    const double distance = 0.5 * (0.25 + 2.5 * 0.008);  // half the length at the axis' middle
    EXPECT_NEAR(data.values("target_dist")[0], distance, 1e-15);
    const auto l = data.values("l");
    for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_EQ(l[i], -capture.scan.wall().sensing.positions[i].x());
        EXPECT_EQ(l[i + 6], capture.scan.wall().sensing.positions[i].y());
        EXPECT_EQ(l[i + 12], data.values("target_dist")[0]);
    }
}

/// Volume that steps along the grid's two axes span with the direction towards the hidden scene:
/// its sign changes in a mirror.
double handedness(const std::array<core::Vec3, 3>& corner, const core::Vec3& towards_hidden) {
    return (corner[1] - corner[0]).cross(corner[2] - corner[0]).dot(towards_hidden);
}

TEST(ConvNlosWriter, TheirWorldIsNoMirrorImageOfOurs) {
    const TemporaryFolder folder;
    const Capture capture = example_capture(ScanPattern::Confocal);
    write_as("conv-nlos", folder.file("a.mat"), capture);
    const auto l = NlosData(folder.file("a.mat")).values("l");
    std::array<core::Vec3, 3> ours;
    std::array<core::Vec3, 3> theirs;
    const std::array<std::size_t, 3> corners{0, 2, 1};  // of 3 x 2 points: along x, along y
    for (std::size_t i = 0; i < 3; ++i) {
        ours[i] = capture.scan.wall().sensing.positions[corners[i]];
        theirs[i] = {l[corners[i]], l[corners[i] + 6], l[corners[i] + 12]};
    }
    const double right = handedness(ours, core::Vec3::UnitZ());
    ASSERT_NE(right, 0.0);
    EXPECT_NEAR(handedness(theirs, -core::Vec3::UnitZ()), right, 1e-12);  // towards their origin
}

TEST(ConvNlosWriter, TimesAreTheCentresOfBins) {
    const TemporaryFolder folder;
    write_as("conv-nlos", folder.file("a.mat"), example_capture(ScanPattern::Confocal));
    const NlosData data(folder.file("a.mat"));
    EXPECT_EQ(data.values("delta"), std::vector<double>{0.008});
    EXPECT_EQ(data.shape("times"), (std::vector<std::size_t>{1, 5}));
    for (std::size_t bin = 0; bin < 5; ++bin) {
        EXPECT_NEAR(
            data.values("times")[bin], 0.25 + 0.008 * (static_cast<double>(bin) + 0.5), 1e-15);
    }
}

TEST(ConvNlosWriter, OtherTransientsAreLitThenSeenThenTime) {
    const TemporaryFolder folder;
    for (const auto pattern : {ScanPattern::Single, ScanPattern::Exhaustive}) {
        const Capture capture = example_capture(pattern);
        const auto losses = write_as("conv-nlos", folder.file("a.mat"), capture);
        EXPECT_TRUE(std::ranges::count(losses, "grids become lists of points"));
        const NlosData data(folder.file("a.mat"));
        const std::size_t lit = capture.scan.wall().illumination.size();
        EXPECT_EQ(data.shape("transient"), (std::vector<std::size_t>{lit, 6, 5}));
        EXPECT_EQ(data.values("is_confocal"), std::vector<double>{0.0});
        EXPECT_EQ(data.shape("l"), (std::vector<std::size_t>{lit, 3}));
        EXPECT_EQ(data.shape("s"), (std::vector<std::size_t>{6, 3}));
        const auto transient = data.values("transient");
        for (std::size_t pair = 0; pair < 6 * lit; ++pair) {
            for (std::size_t bin = 0; bin < 5; ++bin) {
                EXPECT_EQ(transient[pair / 6 + lit * (pair % 6 + 6 * bin)],
                          capture.transient.histogram(pair)[bin]);
            }
        }
    }
}

TEST(ConvNlosWriter, RefusesWhatIsNotOnTheWallAtZero) {
    const TemporaryFolder folder;
    const auto expect = [&](const Capture& capture, const std::string& part) {
        EXPECT_ERROR_WITH(write_as("conv-nlos", folder.file("a.mat"), capture), part);
    };
    expect(test_support::example_image(), "camera");
    Capture capture = example_capture(ScanPattern::Exhaustive);
    capture.scan.wall().opl_origin = core::OplOrigin::Device;
    expect(capture, "device segments");
    capture = example_capture(ScanPattern::Exhaustive);
    capture.scan.wall().sensing.positions[4].z() = 0.01;
    expect(capture, "point 4");
    capture = example_capture(ScanPattern::Exhaustive);
    capture.scan.wall().illumination.normals[2] = -core::Vec3::UnitZ();
    expect(capture, "point 2");
}

/// Expects the same histograms at the same points, in whatever order.
void expect_same_pairs(const Capture& read, const Capture& written) {
    ASSERT_EQ(read.scan.wall().pattern, written.scan.wall().pattern);
    ASSERT_EQ(read.scan.num_pairs(), written.scan.num_pairs());
    EXPECT_EQ(read.scan.wall().opl_origin, core::OplOrigin::RelayWall);
    const auto distance = [](const core::WallPoints& a, std::size_t i, const core::Vec3& b) {
        return (a.positions[i] - b).norm();
    };
    for (std::size_t pair = 0; pair < written.scan.num_pairs(); ++pair) {
        const core::WallScan& scan = written.scan.wall();
        const core::Vec3& lit = scan.illumination.positions[scan.illumination_index(pair)];
        const core::Vec3& seen = scan.sensing.positions[scan.sensing_index(pair)];
        std::size_t same = 0;
        while (same < scan.num_pairs() &&
               (distance(read.scan.wall().illumination,
                         read.scan.wall().illumination_index(same),
                         lit) > 1e-6 ||
                distance(read.scan.wall().sensing, read.scan.wall().sensing_index(same), seen) >
                    1e-6)) {
            ++same;
        }
        ASSERT_LT(same, scan.num_pairs()) << "pair " << pair << " is missing";
        EXPECT_TRUE(
            std::ranges::equal(read.transient.histogram(same), written.transient.histogram(pair)));
        EXPECT_EQ(read.scan.wall().sensing.normals[read.scan.wall().sensing_index(same)],
                  core::Vec3::UnitZ());
    }
}

TEST(StanfordFkWriter, FilesAreReadAsTheyWere) {
    const TemporaryFolder folder;
    for (const auto unit : {core::TransientUnit::Radiance, core::TransientUnit::Counts}) {
        Capture capture = example_square();
        capture.unit = unit;
        capture.transient.values()[5] = 0.3F;
        write_as("stanford-fk-2019", folder.file("a.mat"), capture);
        const Capture read = read_capture(folder.file("a.mat"));
        expect_same_pairs(read, capture);
        EXPECT_EQ(read.unit, unit);
        EXPECT_EQ(read.time_axis.opl_start_m, capture.time_axis.opl_start_m);
        EXPECT_EQ(read.time_axis.bin_width_m, capture.time_axis.bin_width_m);
        write_as("stanford-fk-2019", folder.file("b.mat"), read);
        expect_same_pairs(read_capture(folder.file("b.mat")), capture);
    }
}

TEST(ConvNlosWriter, FilesAreReadAsTheyWere) {
    const TemporaryFolder folder;
    for (const auto pattern :
         {ScanPattern::Confocal, ScanPattern::Single, ScanPattern::Exhaustive}) {
        const Capture capture = example_capture(pattern);
        write_as("conv-nlos", folder.file("a.mat"), capture);
        const Capture read = read_capture(folder.file("a.mat"));
        expect_same_pairs(read, capture);
        EXPECT_NEAR(read.time_axis.opl_start_m, capture.time_axis.opl_start_m, 1e-12);
        EXPECT_EQ(read.time_axis.bin_width_m, capture.time_axis.bin_width_m);
    }
}

TEST(CaptureWriters, LayoutsAreNamedAndFitTheSuffix) {
    const TemporaryFolder folder;
    const Capture capture = example_square();
    EXPECT_ERROR_WITH(write_as("mat", folder.file("a.mat"), capture),
                      "layout: 'mat' is none that is written; must be one of y-tal, npz, exr, "
                      "stanford-2018, stanford-fk-2019, conv-nlos");
    EXPECT_ERROR_WITH(write_as("conv-nlos", folder.file("a.h5"), capture),
                      "has the suffix '.h5'; must be one of .mat for the layout conv-nlos");
    EXPECT_ERROR_WITH(write_as("", folder.file("a.png"), capture), ".h5, .hdf5, .npz, .exr, .mat");
    write_as("stanford-2018", folder.file("a.mat"), capture);
    write_as("", folder.file("b.mat"), capture);
    EXPECT_EQ(capture_format(folder.file("a.mat")), capture_format(folder.file("b.mat")));
}

}  // namespace
}  // namespace nlos
