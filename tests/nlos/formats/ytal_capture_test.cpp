// SPDX-License-Identifier: MIT
#include "nlos/containers/array_reader.h"
#include "nlos/formats/capture_file.h"
#include "nlos/formats/ytal_layout.h"
#include "renderer/core/capture/left_out_orders.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/settings/settings_json.h"
#include "tests/nlos/formats/ytal_capture_file.h"
#include "tests/support/error_message.h"
#include "tests/support/example_capture.h"

#include <gtest/gtest.h>
#include <hdf5.h>

#include <algorithm>
#include <map>

namespace nlos {
namespace {

using core::Capture;
using core::ScanPattern;
using test_support::example_capture;

TEST(YtalCapture, EveryScanPatternSurvivesTheRoundTrip) {
    for (const auto pattern :
         {ScanPattern::Confocal, ScanPattern::Single, ScanPattern::Exhaustive}) {
        const Capture capture = example_capture(pattern);
        expect_same(CaptureFile(capture).read(), capture);
    }
}

TEST(YtalCapture, BounceOrdersSurviveTheRoundTrip) {
    Capture capture = example_capture(ScanPattern::Exhaustive);
    capture.orders = {3, 5};
    capture.by_order = {capture.transient, capture.transient};
    for (float& value : capture.by_order[1].values()) value *= -2.0F;
    const Capture read = CaptureFile(capture).read();
    expect_same(read, capture);
    EXPECT_EQ(read.orders, capture.orders);
    ASSERT_EQ(read.by_order.size(), 2U);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_TRUE(std::ranges::equal(read.by_order[i].values(), capture.by_order[i].values()));
    }
}

TEST(YtalCapture, PointListsSurviveTheRoundTrip) {
    for (const auto pattern :
         {ScanPattern::Confocal, ScanPattern::Single, ScanPattern::Exhaustive}) {
        Capture capture = example_capture(pattern);
        capture.scan.wall().sensing = test_support::as_list(capture.scan.wall().sensing);
        capture.scan.wall().illumination = test_support::as_list(capture.scan.wall().illumination);
        expect_same(CaptureFile(capture).read(), capture);
    }
}

TEST(YtalCapture, PlacesFarFromTheOriginSurviveTheRoundTrip) {
    for (const double kilometres : {0.1, 1.0, 1000.0}) {
        const core::Vec3 way = 1000.0 * kilometres * core::Vec3(0.49999, -1.0, 0.7);
        Capture capture = example_capture(ScanPattern::Single);
        capture.scan = core::moved(capture.scan, way);
        capture.scan.wall().opl_origin = core::OplOrigin::Device;
        capture.scan.wall().laser_position = way + core::Vec3(-0.5, 0.1, 1.0 / 3.0);
        capture.scan.wall().detector_position = way + core::Vec3(0.7, 0.125, 1.0);
        expect_same(CaptureFile(capture).read(), capture);
    }
}

TEST(YtalCapture, ImagesSurviveTheRoundTrip) {
    const Capture capture = test_support::example_image();
    const CaptureFile file(capture);
    const Capture read = file.read();
    ASSERT_FALSE(read.scan.has_wall());
    EXPECT_EQ(test_support::camera_json(read), test_support::camera_json(capture));
    EXPECT_TRUE(std::ranges::equal(read.transient.values(), capture.transient.values()));
    EXPECT_EQ(read.scan.num_pairs(), 6U);
    EXPECT_EQ(read.scan.opl_origin(), core::OplOrigin::Device);
}

TEST(YtalCapture, FramesSurviveTheRoundTrip) {
    for (Capture capture :
         {example_capture(ScanPattern::Exhaustive), test_support::example_image()}) {
        core::FrameSequence sequence{{capture.transient, capture.transient}, 0.02, 0.04};
        for (float& value : sequence.frames[0].values()) value *= -3.0F;
        sequence.errors = {0.25, std::numeric_limits<double>::quiet_NaN()};
        capture.sequence = sequence;
        const Capture read = CaptureFile(capture).read();
        ASSERT_TRUE(read.sequence.has_value());
        EXPECT_EQ(read.sequence->gate_step_m, 0.02);
        EXPECT_EQ(read.sequence->frame_s, 0.04);
        ASSERT_EQ(read.sequence->errors.size(), 2U);
        EXPECT_EQ(read.sequence->errors[0], 0.25);
        EXPECT_TRUE(std::isnan(read.sequence->errors[1]));
        ASSERT_EQ(read.sequence->frames.size(), 2U);
        for (std::size_t i = 0; i < 2; ++i) {
            EXPECT_TRUE(
                std::ranges::equal(read.sequence->frames[i].values(), sequence.frames[i].values()));
        }
    }
}

TEST(YtalCapture, LeftOutOrdersAreAttributesOfHistograms) {
    Capture capture = example_capture(ScanPattern::Confocal);
    const core::Json orders = {{"first", 4}, {"last", 6}, {"error", 0.01}, {"share", 0.02}};
    capture.scene_info[core::kLeftOutOrdersKey] = orders;
    const CaptureFile file(capture);
    expect_same(file.read(), capture);
    const ArrayReader reader(file.path());
    EXPECT_EQ(reader.real_attribute("H", "orders_left_out"), (std::vector{4.0, 6.0}));
    EXPECT_EQ(reader.real_attribute("H", "orders_left_out_error"), std::vector{0.01});
    EXPECT_EQ(reader.real_attribute("H", "orders_left_out_share"), std::vector{0.02});

    // Another program's scene_info.
    file.remove("scene_info");
    const Capture read = file.read();
    EXPECT_EQ(read.scene_info->at(core::kLeftOutOrdersKey), orders);
    std::string text;
    for (const auto& line : describe_capture(read)) text += line + "\n";
    EXPECT_NE(text.find("left out: bounces of orders 4 to 6, some 2 % of the light; an error of "
                        "0.01, relative L2\n"),
              std::string::npos)
        << text;
    const ArrayReader without(CaptureFile(example_capture(ScanPattern::Confocal)).path());
    EXPECT_FALSE(without.real_attribute("H", "orders_left_out"));
}

TEST(YtalCapture, PointsAndNormalsStateThatTheyAreInTheWorld) {
    const CaptureFile file(example_capture(ScanPattern::Single));
    const ArrayReader reader(file.path());
    for (const std::string device : {"sensor", "laser"}) {
        for (const std::string name : {"_xyz", "_grid_xyz", "_grid_normals"}) {
            EXPECT_EQ(reader.text_attribute(device + name, "frame"), "world");
            EXPECT_EQ(reader.text_attribute(device + name, "units"),
                      name == "_grid_normals" ? "1" : "m");
        }
    }
}

TEST(YtalCapture, ImagesHaveNullGrids) {
    const CaptureFile file(test_support::example_image());
    const ArrayReader reader(file.path());
    EXPECT_EQ(reader.shape("H"), (Shape{5, 3, 2}));
    for (const char* name : {"sensor_grid_xyz", "laser_grid_normals"}) {
        EXPECT_TRUE(reader.has_object(name)) << name;
        EXPECT_FALSE(reader.has(name)) << name;
    }
}

TEST(YtalCapture, GridAndListTogetherAreWrittenAsLists) {
    Capture capture = example_capture(ScanPattern::Exhaustive);
    capture.scan.wall().sensing = test_support::as_list(capture.scan.wall().sensing);
    const Capture read = CaptureFile(capture).read();
    capture.scan.wall().illumination = test_support::as_list(capture.scan.wall().illumination);
    expect_same(read, capture);
}

TEST(YtalCapture, UnitVarianceAndDevicesSurviveTheRoundTrip) {
    Capture capture = example_capture(ScanPattern::Confocal);
    capture.unit = core::TransientUnit::Counts;
    capture.variance = capture.transient;
    capture.scan.wall().opl_origin = core::OplOrigin::Device;
    capture.scan.wall().laser_position = {-0.5, 0.0, 0.25};
    capture.scan.wall().detector_position = {0.5, 0.125, 0.25};
    expect_same(CaptureFile(capture).read(), capture);
}

TEST(YtalCapture, ArraysOfManyBlocksKeepTheirOrder) {
    Capture capture = example_capture(ScanPattern::Confocal);
    capture.scan.wall().sensing = test_support::example_grid(40, 41);
    capture.scan.wall().illumination = capture.scan.wall().sensing;
    capture.time_axis.num_bins = 3001;  // more values than are read or written at once
    capture.transient = core::Transient(capture.scan.num_pairs(), 3001);
    float next = 0.0F;
    for (float& value : capture.transient.values()) value = next += 1.0F;
    expect_same(CaptureFile(capture).read(), capture);
}

// The layout check: everything that h5py would show of a file written by y-tal 0.20.

struct Field {
    H5T_class_t type_class;
    std::size_t bytes;
    H5S_class_t space;
    Shape shape;
    std::map<std::string, int> members;

    bool operator==(const Field&) const = default;
};

Field field_of(hid_t file, const char* name) {
    const Hdf5Handle set(H5Dopen2(file, name, H5P_DEFAULT), H5Dclose);
    const Hdf5Handle type(H5Dget_type(set.id()), H5Tclose);
    const Hdf5Handle space(H5Dget_space(set.id()), H5Sclose);
    Field field{H5Tget_class(type.id()),
                H5Tget_size(type.id()),
                H5Sget_simple_extent_type(space.id()),
                {},
                {}};
    std::vector<hsize_t> extents(8);
    const int rank = H5Sget_simple_extent_dims(space.id(), extents.data(), nullptr);
    field.shape.assign(extents.begin(), extents.begin() + rank);
    const int members = field.type_class == H5T_ENUM ? H5Tget_nmembers(type.id()) : 0;
    for (unsigned i = 0; i < static_cast<unsigned>(members); ++i) {
        char* member = H5Tget_member_name(type.id(), i);
        std::int64_t value = 0;
        H5Tget_member_value(type.id(), i, &value);
        field.members[member] =
            field.bytes == 1 ? static_cast<std::int8_t>(value) : static_cast<std::int32_t>(value);
        H5free_memory(member);
    }
    return field;
}

std::vector<std::string> names_in_root(hid_t file) {
    std::vector<std::string> names;
    H5Literate(
        file,
        H5_INDEX_NAME,
        H5_ITER_INC,
        nullptr,
        [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
            static_cast<std::vector<std::string>*>(list)->emplace_back(name);
            return 0;
        },
        &names);
    return names;
}

TEST(YtalCapture, EveryFieldIsLaidOutAsYtalWritesIt) {
    const std::map<std::string, int> h_formats{{"UNKNOWN", 0},
                                               {"T_Sx_Sy", 1},
                                               {"T_Lx_Ly_Sx_Sy", 2},
                                               {"T_Si", 3},
                                               {"T_Li_Si", 4},
                                               {"F_Sx_Sy", 10},
                                               {"F_Lx_Ly_Sx_Sy", 11},
                                               {"F_Si", 12},
                                               {"F_Li_Si", 13}};
    const std::map<std::string, int> grid_formats{{"UNKNOWN", 0}, {"N_3", 1}, {"X_Y_3", 2}};
    const std::map<std::string, int> volume_formats{
        {"UNKNOWN", 0}, {"N_3", 1}, {"X_Y_Z_3", 2}, {"X_Y_3", 3}};
    const Field grid{H5T_FLOAT, 4, H5S_SIMPLE, {3, 2, 3}, {}};
    const Field position{H5T_FLOAT, 4, H5S_SIMPLE, {3}, {}};
    const Field number{H5T_FLOAT, 8, H5S_SCALAR, {}, {}};
    const std::map<std::string, Field> expected{
        {"H", {H5T_FLOAT, 4, H5S_SIMPLE, {5, 3, 2}, {}}},
        {"H_format", {H5T_ENUM, 4, H5S_SIMPLE, {1}, h_formats}},
        {"delta_t", number},
        {"laser_grid_format", {H5T_ENUM, 4, H5S_SIMPLE, {1}, grid_formats}},
        {"laser_grid_normals", grid},
        {"laser_grid_xyz", grid},
        {"laser_xyz", position},
        {"scene_info", {H5T_STRING, sizeof(char*), H5S_SCALAR, {}, {}}},
        {"sensor_grid_format", {H5T_ENUM, 4, H5S_SIMPLE, {1}, grid_formats}},
        {"sensor_grid_normals", grid},
        {"sensor_grid_xyz", grid},
        {"sensor_xyz", position},
        {"t_accounts_first_and_last_bounces",
         {H5T_ENUM, 1, H5S_SCALAR, {}, {{"FALSE", 0}, {"TRUE", 1}}}},
        {"t_start", number},
        {"volume_format", {H5T_ENUM, 4, H5S_SIMPLE, {1}, volume_formats}}};

    const CaptureFile written(example_capture(ScanPattern::Confocal));
    written.edit([&](hid_t file) {
        std::vector<std::string> names;
        for (const auto& [name, field] : expected) {
            names.push_back(name);
            EXPECT_EQ(field_of(file, name.c_str()), field) << name;
        }
        EXPECT_EQ(names_in_root(file), names);  // y-tal refuses any other name
    });
}

TEST(YtalCapture, TimeIsSlowestAndXComesBeforeY) {
    const Capture capture = example_capture(ScanPattern::Confocal);
    CaptureFile(capture).edit([&](hid_t file) {
        std::vector<float> values(30);
        const Hdf5Handle set(H5Dopen2(file, "H", H5P_DEFAULT), H5Dclose);
        H5Dread(set.id(), H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
        // (t, x, y) = (4, 2, 1) of (5, 3, 2)
        EXPECT_EQ(values[4 * 6 + 2 * 2 + 1], capture.transient.histogram(2 * 2 + 1)[4]);
    });
}

// What others write differently.

TEST(YtalCapture, PlainNumbersStandForEnumerationsAndTruthValues) {
    const Capture capture = example_capture(ScanPattern::Exhaustive);
    const CaptureFile file(capture);
    file.replace<int>("H_format", H5T_NATIVE_INT, {}, {2});
    file.replace<std::int64_t>("sensor_grid_format", H5T_NATIVE_INT64, {1}, {2});
    file.replace<std::int8_t>("t_accounts_first_and_last_bounces", H5T_NATIVE_INT8, {1}, {0});
    file.replace<double>("delta_t", H5T_NATIVE_DOUBLE, {1}, {0.008});
    file.replace<float>("t_start", H5T_NATIVE_FLOAT, {}, {0.25F});
    expect_same(file.read(), capture);
}

TEST(YtalCapture, MissingOptionalDatasetsAreFilledInAndNoted) {
    const Capture capture = example_capture(ScanPattern::Single);
    const CaptureFile file(capture);
    for (const char* name : {"H_format", "sensor_grid_normals", "laser_grid_normals"}) {
        file.remove(name);
    }
    for (const char* name : {"sensor_xyz", "laser_xyz", "sensor_grid_format", "volume_format"}) {
        file.replace_by_none(name);
    }
    const Capture read = file.read();
    expect_same(read, capture);
    ASSERT_EQ(read.notes.size(), 2U);
    EXPECT_NE(read.notes[0].find("sensor_grid_normals is missing"), std::string::npos);
    EXPECT_NE(read.notes[1].find("laser_grid_normals is missing"), std::string::npos);
}

TEST(YtalCapture, LaserNormalsOfTheWrongSizeGiveWayToTheWallsInSingleScans) {
    const Capture capture = example_capture(ScanPattern::Single);
    const CaptureFile file(capture);
    file.replace("laser_grid_normals", H5T_NATIVE_FLOAT, {3, 2, 3}, ramp(18));
    const Capture read = file.read();
    expect_same(read, capture);
    ASSERT_EQ(read.notes.size(), 1U);
    EXPECT_NE(read.notes[0].find("has shape (3, 2, 3)"), std::string::npos);
}

TEST(YtalCapture, DoublePrecisionAndCountsAreConverted) {
    const Capture capture = example_capture(ScanPattern::Confocal);
    const CaptureFile file(capture);
    file.replace<double>("H", H5T_NATIVE_DOUBLE, {5, 3, 2}, std::vector<double>(30, 0.75));
    EXPECT_EQ(file.read().transient.values()[17], 0.75F);
    file.replace<std::uint16_t>(
        "H", H5T_NATIVE_UINT16, {5, 3, 2}, std::vector<std::uint16_t>(30, 9));
    EXPECT_EQ(file.read().transient.values()[17], 9.0F);
}

TEST(YtalCapture, CompressedHistogramsAreRead) {
    const Capture capture = example_capture(ScanPattern::Confocal);
    const CaptureFile file(capture);
    std::vector<float> values(30);
    for (std::size_t pair = 0; pair < 6; ++pair) {
        for (std::size_t bin = 0; bin < 5; ++bin) {
            values[bin * 6 + pair] = capture.transient.histogram(pair)[bin];
        }
    }
    file.edit([&](hid_t id) {
        const hsize_t extents[]{5, 3, 2};
        const hsize_t chunk[]{2, 3, 1};
        H5Ldelete(id, "H", H5P_DEFAULT);
        const Hdf5Handle space(H5Screate_simple(3, extents, nullptr), H5Sclose);
        const Hdf5Handle plan(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
        H5Pset_chunk(plan.id(), 3, chunk);
        H5Pset_deflate(plan.id(), 4);
        const Hdf5Handle set(
            H5Dcreate2(id, "H", H5T_NATIVE_FLOAT, space.id(), H5P_DEFAULT, plan.id(), H5P_DEFAULT),
            H5Dclose);
        H5Dwrite(set.id(), H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    });
    expect_same(file.read(), capture);
}

TEST(YtalCapture, SettingsShiftTheAxisAndZeroBins) {
    const CaptureFile file(example_capture(ScanPattern::Confocal));
    CaptureReadSettings settings;
    settings.zero_bins = 2;
    settings.opl_shift_m = -0.25;
    settings.bin_width_m = 0.5;
    const Capture capture = read_capture(file.path(), settings);
    EXPECT_EQ(capture.time_axis.opl_start_m, 0.0);
    EXPECT_EQ(capture.time_axis.bin_width_m, 0.5);
    EXPECT_EQ(capture.transient.histogram(3)[1], 0.0F);
    EXPECT_NE(capture.transient.histogram(3)[2], 0.0F);
    settings.zero_bins = -1;
    EXPECT_ERROR_WITH(read_capture(file.path(), settings), "capture.zero_bins: found -1; must");
}

TEST(YtalCapture, SceneInfoInYamlIsKeptWordForWord) {
    const std::string yaml = "original_format: synthetic\npoints:\n- - -0.25\n  - 0.1\n";
    EXPECT_EQ(scene_info_text(parse_scene_info(yaml)), yaml);
}

TEST(YtalCapture, NumbersInSceneInfoAreNumbersInYamlToo) {
    const core::Json info{{"small", 1e-7}, {"half", 0.5}, {"text", "1e-7 \"e\""}};
    const std::string text = scene_info_text(info);
    EXPECT_NE(text.find("1.0e-07"), std::string::npos) << text;
    EXPECT_EQ(core::Json::parse(text), info);
}

TEST(YtalCapture, DescriptionGivesWallBinsAndUnit) {
    std::string text;
    for (const auto& line : describe_capture(example_capture(ScanPattern::Confocal))) text += line;
    EXPECT_NE(text.find("confocal, 3 x 2 sensing points over 0.2 x 0.1 x 0 m"), std::string::npos);
    EXPECT_NE(text.find("5 bins of 0.008 m"), std::string::npos);
    EXPECT_NE(text.find("radiance"), std::string::npos);
    EXPECT_NE(text.find("depth range: 0.125 to 0.145 m"), std::string::npos) << text;
}

}  // namespace
}  // namespace nlos
