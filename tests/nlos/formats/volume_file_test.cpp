// SPDX-License-Identifier: MIT
#include "nlos/formats/volume_file.h"

#include "nlos/containers/array_reader.h"
#include "nlos/formats/capture_file.h"
#include "renderer/core/settings/settings_json.h"
#include "tests/support/error_message.h"
#include "tests/support/example_capture.h"
#include "tests/support/example_reconstruction.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>
#include <hdf5.h>

namespace nlos {
namespace {

using test_support::example_reconstruction;
using test_support::TemporaryFolder;

TEST(VolumeFile, EverythingSurvivesTheRoundTrip) {
    const TemporaryFolder folder;
    const Reconstruction written = example_reconstruction();
    write_volume(folder.file("v.h5"), written);
    EXPECT_TRUE(is_volume_file(folder.file("v.h5")));
    const Reconstruction read = read_volume(folder.file("v.h5"));
    EXPECT_EQ(read.volume.values, written.volume.values);
    EXPECT_EQ(read.volume.normals, written.volume.normals);
    EXPECT_EQ(read.volume.axes.x_m, written.volume.axes.x_m);
    EXPECT_EQ(read.volume.axes.y_m, written.volume.axes.y_m);
    EXPECT_EQ(read.volume.axes.z_m, written.volume.axes.z_m);
    EXPECT_EQ(read.volume.axes.world_from_wall.matrix(),
              written.volume.axes.world_from_wall.matrix());
    EXPECT_EQ(read.depth.depth_m[2], 0.6125);
    EXPECT_FALSE(read.depth.is_foreground(3));
    EXPECT_EQ(read.surface_probability, written.surface_probability);
    EXPECT_EQ(read.depth_sigma_m[2], 0.0015);
    EXPECT_TRUE(std::isnan(read.depth_sigma_m[3]));
    EXPECT_EQ(read.depth.point_world(1, 0), written.points.positions[0]);
    EXPECT_EQ(read.points.positions, written.points.positions);
    EXPECT_EQ(read.points.normals, written.points.normals);
    EXPECT_EQ(read.resolution_m, written.resolution_m);
    EXPECT_EQ(read.method, written.method);
    EXPECT_EQ(read.reason, written.reason);
    EXPECT_EQ(core::write_value(read.settings), core::write_value(written.settings));
    EXPECT_EQ(read.seconds, written.seconds);
    EXPECT_EQ(read.peak_bytes, written.peak_bytes);
}

TEST(VolumeFile, HoldsWhatGeometryTellsAndWhatTheSetUpDoes) {
    const TemporaryFolder folder;
    Reconstruction written = example_reconstruction();
    written.observed = {1, 0, 1, 1, 0, 1};
    const double nan = std::numeric_limits<double>::quiet_NaN();
    written.setup = SetupReport{{}, {nan, nan, 0.0012, nan, nan, nan}, 0.0012, 0.0009};
    written.settings.setup.time_zero_sigma_ps = 8.0;
    write_volume(folder.file("v.h5"), written);
    const ArrayReader file(folder.file("v.h5"));
    EXPECT_EQ(file.read_doubles("observed", {3, 2}), (std::vector{1.0, 0.0, 1.0, 1.0, 0.0, 1.0}));
    EXPECT_EQ(file.read_doubles("setup/depth_sigma_m", {3, 2})[2], 0.0012);
    EXPECT_EQ(file.real_attribute("setup", "depth_sigma_setup_m"), std::vector{0.0012});
    EXPECT_EQ(file.real_attribute("setup", "depth_sigma_noise_m"), std::vector{0.0009});
    EXPECT_EQ(file.real_attribute("setup", "time_zero_sigma_ps"), std::vector{8.0});
    EXPECT_EQ(file.real_attribute("setup", "wall_scale_sigma"), std::vector{0.0});
}

TEST(VolumeFile, AnEmptyResultSurvivesTheRoundTrip) {
    const TemporaryFolder folder;
    Reconstruction written = example_reconstruction();
    written.points = {};
    written.volume.normals.clear();
    written.depth_sigma_m.clear();
    written.surface_probability.clear();
    written.resolution_m.reset();
    write_volume(folder.file("v.h5"), written);
    const Reconstruction read = read_volume(folder.file("v.h5"));
    EXPECT_TRUE(read.points.positions.empty());
    EXPECT_TRUE(read.volume.normals.empty());
    EXPECT_FALSE(read.resolution_m);
    EXPECT_TRUE(read.depth_sigma_m.empty());
    EXPECT_TRUE(read.surface_probability.empty());
}

TEST(VolumeFile, UncertaintiesThatCannotBeAreRefused) {
    const TemporaryFolder folder;
    const std::string path = folder.file("v.h5");
    Reconstruction bad = example_reconstruction();
    bad.surface_probability[1] = 1.5;
    write_volume(path, bad);
    EXPECT_ERROR_WITH(read_volume(path), "surface_probability");
    bad = example_reconstruction();
    bad.depth_sigma_m[0] = 0.001;  // of no depth
    write_volume(path, bad);
    EXPECT_ERROR_WITH(read_volume(path), "depth_sigma_m");
}

TEST(VolumeFile, DatasetsHaveTheNamesAndShapesOfTheContract) {
    const TemporaryFolder folder;
    write_volume(folder.file("v.h5"), example_reconstruction());
    const ArrayReader file(folder.file("v.h5"));
    EXPECT_EQ(file.shape("volume"), (Shape{3, 2, 4}));
    EXPECT_EQ(file.shape("depth_m"), (Shape{3, 2}));
    EXPECT_EQ(file.shape("max_projection"), (Shape{3, 2}));
    EXPECT_EQ(file.shape("normals"), (Shape{3, 2, 3}));
    EXPECT_EQ(file.shape("points"), (Shape{1, 3}));
    for (const char* axis : {"x_m", "y_m", "z_m"}) {
        const auto pose = file.real_attribute(axis, "world_from_wall");
        ASSERT_TRUE(pose);
        EXPECT_EQ((*pose)[3], 1.0);  // rows first: the last column is the translation
        EXPECT_EQ((*pose)[7], 2.0);
        EXPECT_EQ((*pose)[11], 3.0);
    }
    EXPECT_EQ(file.read_floats("max_projection", {3, 2})[0], 3.25F);
    EXPECT_EQ(file.text_attribute("/", "method"), "lct");
    EXPECT_EQ(file.real_attribute("/", "seconds"), std::vector<double>{1.5});
}

const std::vector<std::string> kPlaces{"x_m", "y_m", "z_m", "depth_m", "depth_sigma_m", "points"};
const std::vector<std::string> kDirections{"normals", "point_normals"};

TEST(VolumeFile, PlacesAndDirectionsStateTheirFrameAndUnit) {
    const TemporaryFolder folder;
    write_volume(folder.file("v.h5"), example_reconstruction());
    const ArrayReader file(folder.file("v.h5"));
    for (const auto& [names, unit] : {std::pair{kPlaces, "m"}, std::pair{kDirections, "1"}}) {
        for (const std::string& name : names) {
            EXPECT_EQ(file.text_attribute(name, "frame"),
                      name.starts_with("point") ? "world" : "wall");
            EXPECT_EQ(file.text_attribute(name, "units"), unit) << name;
        }
    }
}

TEST(VolumeFile, FilesThatStateNoFrameAreRead) {
    const TemporaryFolder folder;
    const std::string path = folder.file("v.h5");
    const Reconstruction written = example_reconstruction();
    write_volume(path, written);
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    for (const auto& names : {kPlaces, kDirections}) {
        for (const std::string& name : names) {
            for (const char* attribute : {"frame", "units"}) {
                EXPECT_GE(H5Adelete_by_name(file, name.c_str(), attribute, H5P_DEFAULT), 0);
            }
        }
    }
    H5Fclose(file);
    const Reconstruction read = read_volume(path);
    EXPECT_EQ(read.volume.axes.x_m, written.volume.axes.x_m);
    EXPECT_EQ(read.depth.point_world(1, 0), written.points.positions[0]);
    EXPECT_EQ(read.points.positions, written.points.positions);
}

TEST(VolumeFile, OtherFilesAreRefused) {
    const TemporaryFolder folder;
    const std::string capture = folder.file("c.h5");
    write_capture(capture, test_support::example_capture(core::ScanPattern::Confocal));
    EXPECT_FALSE(is_volume_file(capture));
    EXPECT_ERROR_WITH(read_volume(capture), "c.h5: x_m: is missing");
    EXPECT_ERROR_WITH(read_volume(folder.file("none.h5")), "none.h5: cannot be opened");
    EXPECT_FALSE(is_volume_file(folder.file("none.h5")));
}

TEST(VolumeFile, NumbersThatAreNotFiniteAreRefused) {
    const TemporaryFolder folder;
    Reconstruction broken = example_reconstruction();
    broken.volume.values[5] = std::nanf("");
    write_volume(folder.file("v.h5"), broken);
    EXPECT_ERROR_WITH(read_volume(folder.file("v.h5")), "volume: found nan");
    broken = example_reconstruction();
    broken.depth.depth_m[0] = HUGE_VAL;
    write_volume(folder.file("v.h5"), broken);
    EXPECT_ERROR_WITH(read_volume(folder.file("v.h5")), "depth_m: found inf");
}

TEST(VolumeFile, MissingAndMisshapenDatasetsAreNamed) {
    const TemporaryFolder folder;
    const std::string path = folder.file("v.h5");
    for (const char* name : {"volume", "x_m", "y_m", "z_m", "depth_m", "points"}) {
        write_volume(path, example_reconstruction());
        const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
        H5Ldelete(file, name, H5P_DEFAULT);
        H5Fclose(file);
        EXPECT_ERROR_WITH(read_volume(path), std::string(name) + ": is missing");
    }
    Reconstruction longer = example_reconstruction();
    longer.volume.axes.z_m.push_back(0.9);
    longer.volume.values.resize(30);
    write_volume(path, longer);
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    H5Ldelete(file, "z_m", H5P_DEFAULT);
    H5Lcreate_hard(file, "x_m", file, "z_m", H5P_DEFAULT, H5P_DEFAULT);
    H5Fclose(file);
    EXPECT_ERROR_WITH(read_volume(path), "volume: has shape (3, 2, 5); must have shape (3, 2, 3)");
}

TEST(VolumeFile, EveryTruncationIsReported) {
    const TemporaryFolder folder;
    const std::string path = folder.file("v.h5");
    write_volume(path, example_reconstruction());
    const std::string bytes = test_support::file_bytes(path);
    for (std::size_t length = 0; length < bytes.size(); length += 1 + bytes.size() / 97) {
        test_support::write_file_bytes(path, bytes.substr(0, length));
        EXPECT_ERROR_WITH(read_volume(path), path) << length;
    }
}

}  // namespace
}  // namespace nlos
