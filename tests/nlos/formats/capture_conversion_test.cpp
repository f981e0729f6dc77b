// SPDX-License-Identifier: MIT
// Captures from one format to another and back.
#include "nlos/containers/exr_table.h"
#include "nlos/formats/capture_file.h"
#include "nlos/preparation/gated_capture.h"
#include "renderer/core/settings/settings_json.h"
#include "tests/nlos/formats/old_hdf5_file.h"
#include "tests/nlos/formats/ytal_capture_file.h"
#include "tests/support/error_message.h"
#include "tests/support/example_capture.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace nlos {
namespace {

using core::Capture;
using core::ScanPattern;
using test_support::example_capture;
using test_support::TemporaryFolder;

/// A capture on a turned wall with everything that a file may hold.
Capture full_capture(ScanPattern pattern) {
    Capture capture = example_capture(pattern);
    const core::Transform turn = Eigen::Translation3d(0.3, -1.0, 2.0) *
                                 Eigen::AngleAxisd(0.7, core::Vec3(1.0, 2.0, -1.0).normalized());
    for (core::WallPoints* points :
         {&capture.scan.wall().sensing, &capture.scan.wall().illumination}) {
        for (core::Vec3& position : points->positions) position = turn * position;
        for (core::Vec3& normal : points->normals) normal = turn.linear() * normal;
    }
    capture.scan.wall().opl_origin = core::OplOrigin::Device;
    capture.scan.wall().laser_position = {-0.5, 0.25, 1.5};
    capture.scan.wall().detector_position = {0.5, 0.125, 1.0};
    capture.time_axis.opl_start_m = -0.1234567890123;
    capture.time_axis.bin_width_m = 0.00799446554;
    capture.unit = core::TransientUnit::Counts;
    capture.counts_per_radiance = 12345.678901234;
    capture.variance = capture.transient;
    capture.orders = {3, 4, 11};
    capture.by_order.assign(3, capture.transient);
    for (float& value : capture.by_order[1].values()) value *= -0.37F;
    return capture;
}

void expect_all_the_same(const Capture& a, const Capture& b) {
    expect_same(a, b);
    EXPECT_EQ(a.counts_per_radiance, b.counts_per_radiance);
    EXPECT_EQ(a.orders, b.orders);
    ASSERT_EQ(a.by_order.size(), b.by_order.size());
    for (std::size_t i = 0; i < a.by_order.size(); ++i) {
        EXPECT_TRUE(std::ranges::equal(a.by_order[i].values(), b.by_order[i].values()));
    }
}

TEST(CaptureConversion, Hdf5AndExrKeepEverythingBothWays) {
    const TemporaryFolder folder;
    for (const auto pattern :
         {ScanPattern::Confocal, ScanPattern::Single, ScanPattern::Exhaustive}) {
        const Capture capture = full_capture(pattern);
        EXPECT_TRUE(write_capture(folder.file("a.h5"), capture).empty());
        const Capture from_h5 = read_capture(folder.file("a.h5"));
        EXPECT_TRUE(write_capture(folder.file("b.exr"), from_h5).empty());
        const Capture from_exr = read_capture(folder.file("b.exr"));
        write_capture(folder.file("c.hdf5"), from_exr);
        expect_all_the_same(from_exr, capture);
        expect_all_the_same(read_capture(folder.file("c.hdf5")), capture);
        EXPECT_EQ(capture_format(folder.file("b.exr")), "OpenEXR");
    }
}

TEST(CaptureConversion, ExrKeepsPointLists) {
    const TemporaryFolder folder;
    Capture capture = full_capture(ScanPattern::Exhaustive);
    capture.scan.wall().sensing = test_support::as_list(capture.scan.wall().sensing);
    capture.scan.wall().illumination = test_support::as_list(capture.scan.wall().illumination);
    write_capture(folder.file("list.exr"), capture);
    expect_all_the_same(read_capture(folder.file("list.exr")), capture);
}

TEST(CaptureConversion, ExrIsAStreakImage) {
    const TemporaryFolder folder;
    const Capture capture = example_capture(ScanPattern::Exhaustive);
    write_capture(folder.file("streak.exr"), capture);
    const ExrTable table = read_exr_table(folder.file("streak.exr"));
    EXPECT_EQ(table.width, 5U);
    EXPECT_EQ(table.height, 24U);
    EXPECT_TRUE(std::ranges::equal(table.channels.at("Y"), capture.transient.values()));
    EXPECT_EQ(table.numbers.at("nlosBinWidthM"), 0.008);
    EXPECT_EQ(table.texts.at("nlosPattern"), "exhaustive");
}

TEST(CaptureConversion, SteadyStateExrIsTheWallFromItsFront) {
    const TemporaryFolder folder;
    Capture capture = example_capture(ScanPattern::Single);
    capture = gated_capture(capture, 0.25, 5 * 0.008);
    write_capture(folder.file("wall.exr"), capture);
    const ExrTable table = read_exr_table(folder.file("wall.exr"));
    ASSERT_EQ(table.width, 3U);
    ASSERT_EQ(table.height, 2U);
    // y upwards, x from right to left: top left is the last column's last row.
    EXPECT_EQ(table.channels.at("Y")[0], capture.transient.histogram(2 * 2 + 1)[0]);
    EXPECT_EQ(table.channels.at("Y")[5], capture.transient.histogram(0)[0]);
    expect_same(read_capture(folder.file("wall.exr")), capture);
}

TEST(CaptureConversion, GateSumsWhatItCovers) {
    Capture capture = example_capture(ScanPattern::Confocal);
    capture.variance = capture.transient;
    const auto h = capture.transient.histogram(2);
    const Capture all = gated_capture(capture, 0.25, 0.04);
    EXPECT_NEAR(all.transient.histogram(2)[0], h[0] + h[1] + h[2] + h[3] + h[4], 1e-4);
    const Capture part = gated_capture(capture, 0.25 + 0.012, 0.016);
    EXPECT_NEAR(part.transient.histogram(2)[0], 0.5 * h[1] + h[2] + 0.5 * h[3], 1e-4);
    EXPECT_NEAR(part.variance->histogram(2)[0], 0.25 * h[1] + h[2] + 0.25 * h[3], 1e-4);
    EXPECT_EQ(part.time_axis.num_bins, 1);
    EXPECT_EQ(part.time_axis.bin_width_m, 0.016);
    EXPECT_ERROR_WITH(gated_capture(capture, 0.2, 0.04), "must be wider than 0 and lie between");
    EXPECT_ERROR_WITH(gated_capture(capture, 0.25, 0.0), "gate");
}

TEST(CaptureConversion, StanfordFilesKeepASquareScan) {
    const TemporaryFolder folder;
    for (const bool whole : {true, false}) {
        Capture capture = test_support::example_square();
        if (whole) {
            capture.unit = core::TransientUnit::Counts;
            capture.counts_per_radiance = 77.5;
        } else {
            capture.transient.values()[5] = 0.3F;
        }
        const auto losses = write_capture(folder.file("a.mat"), capture);
        EXPECT_EQ(losses.size(), whole ? 1U : 2U);
        const Capture read = read_capture(folder.file("a.mat"));
        EXPECT_EQ(read.unit, capture.unit);
        EXPECT_EQ(read.counts_per_radiance, capture.counts_per_radiance);
        EXPECT_EQ(read.time_axis.opl_start_m, capture.time_axis.opl_start_m);
        EXPECT_EQ(read.time_axis.bin_width_m, capture.time_axis.bin_width_m);
        for (std::size_t pair = 0; pair < 9; ++pair) {
            // The file's y descends.
            const std::size_t same = pair / 3 * 3 + 2 - pair % 3;
            EXPECT_LT((read.scan.wall().sensing.positions[pair] -
                       capture.scan.wall().sensing.positions[same])
                          .norm(),
                      1e-12);
            EXPECT_TRUE(std::ranges::equal(read.transient.histogram(pair),
                                           capture.transient.histogram(same)));
        }
        // And once more, now in the file's own order.
        write_capture(folder.file("b.mat"), read);
        expect_same(read_capture(folder.file("b.mat")), read);
    }
}

TEST(CaptureConversion, StanfordFilesRefuseOtherScans) {
    const TemporaryFolder folder;
    const auto expect = [&](const Capture& capture, const std::string& part) {
        EXPECT_ERROR_WITH(write_capture(folder.file("a.mat"), capture), part);
    };
    expect(example_capture(ScanPattern::Exhaustive), "exhaustive");
    expect(example_capture(ScanPattern::Confocal), "square");
    Capture capture = test_support::example_square();
    capture.scan.wall().opl_origin = core::OplOrigin::Device;
    expect(capture, "device segments");
    capture = test_support::example_square();
    capture.scan.wall().sensing.positions[4].z() = 0.01;
    expect(capture, "point 4");
    capture = test_support::example_square();
    for (core::Vec3& position : capture.scan.wall().sensing.positions) position.y() += 0.1;
    expect(capture, "where it is");
}

TEST(CaptureConversion, FilesForYtalKeepTheirUnit) {
    const TemporaryFolder folder;
    Capture capture = example_capture(ScanPattern::Confocal);
    capture.unit = core::TransientUnit::Counts;
    CaptureWriteSettings settings;
    settings.for_ytal = true;
    EXPECT_TRUE(write_capture(folder.file("plain.h5"), capture, settings).empty());
    EXPECT_EQ(test_support::file_bytes(folder.file("plain.h5")).find("unit\0", 0, 5),
              std::string::npos);
    EXPECT_EQ(read_capture(folder.file("plain.h5")).unit, core::TransientUnit::Counts);
    capture.variance = capture.transient;
    EXPECT_EQ(write_capture(folder.file("plain.h5"), capture, settings).size(), 1U);
    EXPECT_FALSE(read_capture(folder.file("plain.h5")).variance);
}

TEST(CaptureConversion, UnknownSuffixesNameTheKnownOnes) {
    const TemporaryFolder folder;
    EXPECT_ERROR_WITH(write_capture(folder.file("a.png"), example_capture(ScanPattern::Single)),
                      ".h5, .hdf5, .npz, .exr, .mat");
}

TEST(CaptureConversion, OtherImagesAreRefused) {
    const TemporaryFolder folder;
    ExrTable table;
    table.width = 2;
    table.height = 2;
    table.channels["R"] = {1.0F, 2.0F, 3.0F, 4.0F};
    write_exr_table(folder.file("image.exr"), table);
    EXPECT_ERROR_WITH(read_capture(folder.file("image.exr")), "nlosFormat");
    const std::string bytes = test_support::file_bytes(folder.file("image.exr"));
    test_support::write_file_bytes(folder.file("cut.exr"), bytes.substr(0, bytes.size() / 2));
    EXPECT_ERROR_WITH(read_capture(folder.file("cut.exr")), "cut.exr");
}

TEST(CaptureConversion, HugeImagesOfSmallFilesAreRefused) {
    const TemporaryFolder folder;
    write_capture(folder.file("a.exr"), example_capture(ScanPattern::Single));
    std::string bytes = test_support::file_bytes(folder.file("a.exr"));
    const std::size_t window = bytes.find("dataWindow");
    ASSERT_NE(window, std::string::npos);
    // Name, type and size of the attribute stand before its four numbers; the third is the width.
    bytes.replace(window + 11 + 6 + 4 + 8, 4, std::string("\xff\xff\xff\x3f", 4));
    test_support::write_file_bytes(folder.file("b.exr"), bytes);
    EXPECT_ERROR_WITH(read_capture(folder.file("b.exr")), "damaged");
}

TEST(CaptureConversion, OldHdf5FilesAreRead) {
    const TemporaryFolder folder;
    const Capture capture = example_capture(ScanPattern::Exhaustive);
    write_old_hdf5(folder.file("old.h5"), capture);
    const Capture read = read_capture(folder.file("old.h5"));
    EXPECT_TRUE(std::ranges::equal(read.transient.values(), capture.transient.values()));
    EXPECT_EQ((*read.scene_info)["seed"], 7);
}

TEST(CaptureConversion, ExrOfACameraHasOneChannelPerBinFromTheTopLeft) {
    const TemporaryFolder folder;
    const Capture image = test_support::example_image();
    EXPECT_TRUE(write_capture(folder.file("image.exr"), image).empty());
    const ExrTable table = read_exr_table(folder.file("image.exr"));
    EXPECT_EQ(table.width, 3U);
    EXPECT_EQ(table.height, 2U);
    ASSERT_EQ(table.channels.size(), 5U);
    for (std::size_t bin = 0; bin < 5; ++bin) {
        const auto& channel = table.channels.at("bin00" + std::to_string(bin));
        for (std::size_t x = 0; x < 3; ++x) {
            for (std::size_t y = 0; y < 2; ++y) {
                EXPECT_EQ(channel[y * 3 + x], image.transient.histogram(2 * x + y)[bin]);
            }
        }
    }
    const Capture read = read_capture(folder.file("image.exr"));
    expect_all_the_same(read, image);
    EXPECT_EQ(test_support::camera_json(read), test_support::camera_json(image));
}

TEST(CaptureConversion, ManyBinsOfAnImageKeepTheirOrder) {
    const TemporaryFolder folder;
    Capture image = test_support::example_image();
    image.time_axis.num_bins = 1200;
    image.transient = core::Transient(6, 1200);
    float next = 0.0F;
    for (float& value : image.transient.values()) value = next += 1.0F;
    write_capture(folder.file("image.exr"), image);
    expect_all_the_same(read_capture(folder.file("image.exr")), image);
}

TEST(CaptureConversion, ExrSaysThatFramesAreLeftOut) {
    const TemporaryFolder folder;
    for (Capture capture : {test_support::example_image(), example_capture(ScanPattern::Single)}) {
        capture.sequence = core::FrameSequence{{capture.transient}, 0.02, 0.04};
        const auto notes = write_capture(folder.file("last.exr"), capture);
        ASSERT_EQ(notes.size(), 1U);
        EXPECT_NE(notes[0].find("frames"), std::string::npos);
    }
}

TEST(CaptureConversion, ExrOfACameraKeepsVelocitiesWithoutTime) {
    const TemporaryFolder folder;
    const std::string path = folder.file("moving.exr");
    Capture image = test_support::example_image();
    core::VelocityAxis axis{-1.0, 0.5, 4};
    image.velocity = {axis, core::Transient(6, 4), std::nullopt};
    float next = 0.0F;
    for (float& value : image.velocity->values.values()) value = next += 0.5F;
    EXPECT_TRUE(write_capture(path, image).empty());
    const Capture read = read_capture(path);
    EXPECT_TRUE(std::ranges::equal(read.transient.values(), image.transient.values()));
    ASSERT_TRUE(read.velocity.has_value());
    EXPECT_EQ(core::write_value(read.velocity->axis), core::write_value(axis));
    EXPECT_TRUE(
        std::ranges::equal(read.velocity->values.values(), image.velocity->values.values()));
    ExrTable table = read_exr_table(path);
    table.texts["nlosVelocityAxis"] = R"({"num_bins": 100})";
    write_exr_table(folder.file("bad.exr"), table);
    EXPECT_ERROR_WITH(read_capture(folder.file("bad.exr")), "has 100 bins");
    image.velocity->axis.with_time = true;
    image.velocity->values = core::Transient(6, 20);
    const auto notes = write_capture(path, image);
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_NE(notes[0].find("velocities with time are left out"), std::string::npos);
    EXPECT_FALSE(read_capture(path).velocity.has_value());
}

TEST(CaptureConversion, DamagedExrImagesAreNamed) {
    const TemporaryFolder folder;
    const std::string path = folder.file("image.exr");
    const Capture image = test_support::example_image();
    write_capture(path, image);
    const auto refused = [&](const std::function<void(ExrTable&)>& change,
                             const std::string& part) {
        ExrTable table = read_exr_table(path);
        change(table);
        write_exr_table(folder.file("bad.exr"), table);
        EXPECT_ERROR_WITH(read_capture(folder.file("bad.exr")), part);
    };
    refused([](ExrTable& t) { t.texts.erase("nlosCamera"); }, "nlosCamera");
    refused([](ExrTable& t) { t.texts["nlosCamera"] = "{"; }, "nlosCamera: is not valid JSON");
    refused([](ExrTable& t) { t.numbers.erase("nlosBinWidthM"); }, "nlosBinWidthM");
    refused([](ExrTable& t) { t.texts["nlosUnit"] = "joule"; }, "nlosUnit");
    refused(
        [](ExrTable& t) {
            t.channels["binary"] = t.channels.at("bin004");
            t.channels.erase("bin004");
        },
        "bin004");
}

}  // namespace
}  // namespace nlos
