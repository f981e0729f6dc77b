// SPDX-License-Identifier: MIT
// Captures in y-tal's layout that cannot be read or written.
#include "nlos/containers/writers/hdf5_writer.h"
#include "nlos/formats/capture_file.h"
#include "nlos/formats/volume_file.h"
#include "tests/nlos/formats/ytal_capture_file.h"
#include "tests/support/error_message.h"
#include "tests/support/example_capture.h"
#include "tests/support/example_reconstruction.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>
#include <hdf5.h>

#include <limits>
#include <map>

namespace nlos {
namespace {

using core::Capture;
using core::ScanPattern;
using test_support::example_capture;
using test_support::TemporaryFolder;

TEST(CaptureRefusals, OtherFilesOfOursAreCalledByTheirName) {
    const TemporaryFolder folder;
    test_support::write_file_bytes(folder.file("scene.json"), R"({"geometry": "scene.glb"})");
    test_support::write_file_bytes(folder.file("a.glb"), "glTF");
    write_volume(folder.file("v.h5"), test_support::example_reconstruction());
    EXPECT_ERROR_WITH(read_capture(folder.file("scene.json")), "is a scene; must be a capture");
    EXPECT_ERROR_WITH(read_capture(folder.file("a.glb")), "is a mesh; must be a capture");
    EXPECT_ERROR_WITH(read_capture(folder.file("v.h5")), "is a volume; must be a capture");
}

TEST(YtalRefusals, NamesTheDatasetThatIsMissingOrMisshapen) {
    const auto expect_message = [](auto&& damage, const std::string& part) {
        const CaptureFile file(example_capture(ScanPattern::Confocal));
        damage(file);
        EXPECT_ERROR_WITH(file.read(), file.path());
        EXPECT_ERROR_WITH(file.read(), part);
    };
    using File = const CaptureFile&;
    expect_message([](File f) { f.remove("delta_t"); }, "delta_t: is missing");
    expect_message([](File f) { f.replace_by_none("H"); }, "H: is missing or empty");
    expect_message([](File f) { f.remove("sensor_grid_xyz"); }, "sensor_grid_xyz: is missing");
    expect_message(
        [](File f) {
            f.replace("H", H5T_NATIVE_FLOAT, {5, 2, 3}, ramp(30));
        },
        "H: has shape (5, 2, 3); must have shape (5, 3, 2)");
    expect_message([](File f) { f.replace("H", H5T_NATIVE_FLOAT, {}, ramp(1)); },
                   "H: has shape ()");
    expect_message([](File f) { f.replace("sensor_grid_xyz", H5T_NATIVE_FLOAT, {6}, ramp(6)); },
                   "must have shape (X, Y, 3) or (N, 3)");
    expect_message(
        [](File f) {
            f.replace("laser_grid_xyz", H5T_NATIVE_FLOAT, {2, 3}, ramp(6));
        },
        "has 2 points that are not the 6 sensor points");
    expect_message([](File f) { f.replace<int>("H_format", H5T_NATIVE_INT, {}, {10}); },
                   "says that H holds frequencies");
    expect_message([](File f) { f.replace<int>("H_format", H5T_NATIVE_INT, {}, {7}); },
                   "H_format: found 7");
    expect_message([](File f) { f.replace("H_format", H5T_NATIVE_FLOAT, {}, ramp(1)); },
                   "holds no whole number");
    expect_message(
        [](File f) {
            f.replace("sensor_grid_normals", H5T_NATIVE_FLOAT, {2, 3}, ramp(6));
        },
        "sensor_grid_normals: has shape (2, 3)");
    expect_message(
        [](File f) {
            f.replace("sensor_grid_normals", H5T_NATIVE_FLOAT, {3, 2, 3}, std::vector<float>(18));
        },
        "has length 0");
    expect_message([](File f) { f.replace<double>("delta_t", H5T_NATIVE_DOUBLE, {}, {0.0}); },
                   "bin_width_m: found 0");
    expect_message(
        [](File f) {
            f.replace("H", H5T_NATIVE_FLOAT, {0, 3, 2}, ramp(1));
        },
        "num_bins: found 0");
}

TEST(YtalRefusals, RefusesNumbersThatAreNotFinite) {
    for (const float bad :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        for (const char* name : {"H", "sensor_grid_xyz", "sensor_grid_normals", "laser_xyz"}) {
            const CaptureFile file(example_capture(ScanPattern::Confocal));
            const std::map<std::string, Shape> shapes{{"H", {5, 3, 2}}, {"laser_xyz", {3}}};
            const auto found = shapes.find(name);
            const Shape shape = found == shapes.end() ? Shape{3, 2, 3} : found->second;
            std::vector<float> values = ramp(30);
            values[2] = bad;
            file.replace(name, H5T_NATIVE_FLOAT, shape, values);
            EXPECT_ERROR_WITH(file.read(), "finite") << name;
        }
    }
}

TEST(YtalRefusals, RefusesShapesThatTheFileCannotHold) {
    const CaptureFile file(example_capture(ScanPattern::Confocal));
    file.edit([](hid_t id) {  // promised but never written
        const hsize_t extents[]{std::size_t{1} << 40, 3, 2};
        H5Ldelete(id, "H", H5P_DEFAULT);
        const Hdf5Handle space(H5Screate_simple(3, extents, nullptr), H5Sclose);
        H5Dclose(H5Dcreate2(
            id, "H", H5T_NATIVE_FLOAT, space.id(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    });
    EXPECT_ERROR_WITH(file.read(), "H");
}

TEST(YtalRefusals, EveryTruncationIsReported) {
    const CaptureFile file(example_capture(ScanPattern::Confocal));
    const std::string bytes = test_support::file_bytes(file.path());
    for (std::size_t length = 0; length < bytes.size(); length += 1 + bytes.size() / 97) {
        test_support::write_file_bytes(file.path(), bytes.substr(0, length));
        EXPECT_ERROR_WITH(file.read(), file.path()) << length;
    }
}

TEST(YtalRefusals, MissingFilesAndForeignFilesAreReported) {
    const TemporaryFolder folder;
    EXPECT_ERROR_WITH(read_capture(folder.file("none.h5")), "none.h5: does not exist");
    test_support::write_file_bytes(folder.file("text.h5"), "just a text");
    EXPECT_ERROR_WITH(read_capture(folder.file("text.h5")), "is no capture in a known format");
    EXPECT_ERROR_WITH(read_capture(folder.path().string()), "is no capture in a known format");
    Hdf5Writer other(folder.file("other.h5"));
    other.write_real("x", 1.0);
    other.finish();
    EXPECT_ERROR_WITH(read_capture(folder.file("other.h5")), "is no capture in a known format");
    EXPECT_EQ(capture_format(folder.file("other.h5")), std::nullopt);
}

TEST(YtalRefusals, AFailedWriteLeavesTheOlderFile) {
    const CaptureFile file(example_capture(ScanPattern::Confocal));
    const std::string before = test_support::file_bytes(file.path());
    Capture broken = example_capture(ScanPattern::Confocal);
    broken.transient.values()[3] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_ERROR_WITH(write_capture(file.path(), broken), "must be finite");
    EXPECT_EQ(test_support::file_bytes(file.path()), before);
    EXPECT_ERROR_WITH(write_capture("/no/such/folder/a.h5", broken), "a.h5");
}

}  // namespace
}  // namespace nlos
