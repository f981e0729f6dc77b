// SPDX-License-Identifier: MIT
// Captures to .npz and back.
#include "nlos/containers/writers/npz_writer.h"
#include "nlos/formats/capture_file.h"
#include "renderer/core/settings/settings_json.h"
#include "tests/nlos/formats/ytal_capture_file.h"
#include "tests/support/error_message.h"
#include "tests/support/example_capture.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

namespace nlos {
namespace {

using core::Capture;
using core::ScanPattern;
using test_support::example_capture;
using test_support::TemporaryFolder;

Capture write_and_read(const Capture& capture) {
    const TemporaryFolder folder;
    EXPECT_TRUE(write_capture(folder.file("a.npz"), capture).empty());
    EXPECT_EQ(capture_format(folder.file("a.npz")), "NumPy .npz");
    return read_capture(folder.file("a.npz"));
}

/// A capture with all that a file holds, at points that single precision does not have.
Capture capture_with_extras(ScanPattern pattern) {
    Capture capture = example_capture(pattern);
    for (core::WallPoints* points :
         {&capture.scan.wall().sensing, &capture.scan.wall().illumination}) {
        for (core::Vec3& position : points->positions) position *= 1.0 / 3.0;
    }
    capture.scan.wall().opl_origin = core::OplOrigin::Device;
    capture.scan.wall().laser_position = {-0.5, 0.1, 1.0 / 3.0};
    capture.scan.wall().detector_position = {0.7, 0.125, 1.0};
    capture.time_axis.opl_start_m = -0.1234567890123;
    capture.time_axis.bin_width_m = 0.00799446554;
    capture.unit = core::TransientUnit::Counts;
    capture.counts_per_radiance = 12345.678901234;
    capture.observed.emplace(capture.scan.num_pairs(), core::BinRange{0, 5});
    (*capture.observed)[1] = {1, 4};
    capture.transient.histogram(1)[0] = capture.transient.histogram(1)[4] = 0.0F;
    capture.variance = capture.transient;
    capture.orders = {3, 11};
    capture.by_order = {capture.transient, capture.transient};
    for (float& value : capture.by_order[1].values()) value *= 0.37F;
    capture.sequence = core::FrameSequence{{capture.by_order[1], capture.transient}, 0.02, 0.04};
    capture.sequence->errors = {0.25, 0.125};
    capture.scene_info["text"] = "\xc3\xbc \xe2\x82\xac \xf0\x9f\x98\x80";
    return capture;
}

void expect_bit_for_bit(const core::WallPoints& a, const core::WallPoints& b) {
    EXPECT_EQ(a.positions, b.positions);
    EXPECT_EQ(a.normals, b.normals);
}

void expect_same_from_npz(const Capture& a, const Capture& b) {
    expect_same(a, b);
    expect_bit_for_bit(a.scan.wall().sensing, b.scan.wall().sensing);
    expect_bit_for_bit(a.scan.wall().illumination, b.scan.wall().illumination);
    EXPECT_EQ(a.scan.wall().laser_position, b.scan.wall().laser_position);
    EXPECT_EQ(a.scan.wall().detector_position, b.scan.wall().detector_position);
    EXPECT_EQ(a.counts_per_radiance, b.counts_per_radiance);
    EXPECT_EQ(a.observed, b.observed);
    EXPECT_EQ(a.orders, b.orders);
    ASSERT_EQ(a.by_order.size(), b.by_order.size());
    for (std::size_t i = 0; i < a.by_order.size(); ++i) {
        EXPECT_TRUE(std::ranges::equal(a.by_order[i].values(), b.by_order[i].values()));
    }
    ASSERT_TRUE(a.sequence && b.sequence);
    EXPECT_EQ(a.sequence->gate_step_m, b.sequence->gate_step_m);
    EXPECT_EQ(a.sequence->frame_s, b.sequence->frame_s);
    ASSERT_EQ(a.sequence->frames.size(), b.sequence->frames.size());
    EXPECT_TRUE(std::ranges::equal(a.sequence->frames[0].values(), b.sequence->frames[0].values()));
}

TEST(NpzCapture, EverythingSurvivesTheRoundTripBitForBit) {
    for (const auto pattern :
         {ScanPattern::Confocal, ScanPattern::Single, ScanPattern::Exhaustive}) {
        Capture capture = capture_with_extras(pattern);
        const Capture read = write_and_read(capture);
        EXPECT_TRUE(read.notes.empty());
        expect_same_from_npz(read, capture);
        capture.scan.wall().sensing = test_support::as_list(capture.scan.wall().sensing);
        capture.scan.wall().illumination = test_support::as_list(capture.scan.wall().illumination);
        expect_same_from_npz(write_and_read(capture), capture);
    }
}

TEST(NpzCapture, ImagesSurviveTheRoundTrip) {
    const Capture image = test_support::example_image();
    const Capture read = write_and_read(image);
    ASSERT_FALSE(read.scan.has_wall());
    EXPECT_EQ(test_support::camera_json(read), test_support::camera_json(image));
    EXPECT_TRUE(std::ranges::equal(read.transient.values(), image.transient.values()));
}

/// What somebody may save: histograms of one value per bin, points and axis.
void write_plain(NpzWriter& file) {
    file.write_rows(
        "H", {4, 1, 2}, [](std::size_t first, std::size_t count, std::vector<float>& values) {
            for (std::size_t i = 0; i < 2 * count; ++i) {
                values[i] = static_cast<float>(first + i / 2);
            }
        });
    const std::vector<double> points{0.0, 0.0, 0.0, 0.0, 0.1, 0.0};
    file.write("sensor_grid_xyz", {1, 2, 3}, points);
    file.write("laser_grid_xyz", {1, 2, 3}, points);
    file.write_real("delta_t", 0.01);
}

TEST(NpzCapture, WhatIsMissingIsAssumedAndSaid) {
    const TemporaryFolder folder;
    NpzWriter file(folder.file("a.npz"));
    write_plain(file);
    file.finish();
    const Capture capture = read_capture(folder.file("a.npz"));
    EXPECT_EQ(capture.scan.wall().pattern, ScanPattern::Confocal);
    EXPECT_EQ(capture.scan.wall().opl_origin, core::OplOrigin::RelayWall);
    EXPECT_EQ(capture.transient.histogram(1)[3], 3.0F);
    EXPECT_EQ(capture.scan.wall().sensing.normals[1], core::Vec3::UnitZ());
    std::string notes;
    for (const std::string& note : capture.notes) notes += note + "\n";
    for (const char* name : {"unit", "t_start", "sensor_grid_normals", "device segments"}) {
        EXPECT_NE(notes.find(name), std::string::npos) << name;
    }
}

TEST(NpzCapture, WrongValuesNameTheirArray) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.npz");
    const auto expect = [&](const std::string& name, const std::string& text) {
        NpzWriter file(path);
        write_plain(file);
        file.write_text(name, text);
        file.finish();
        EXPECT_ERROR_WITH(read_capture(path), "a.npz: " + name);
    };
    expect("unit", "photons");
    expect("opl_origin", "wall");
    expect("t_start", "0.5");
    expect("variance", "0.5");
    NpzWriter file(path);
    write_plain(file);
    file.write_real("counts_per_radiance", -1.0);
    file.finish();
    EXPECT_ERROR_WITH(read_capture(path), "counts_per_radiance: is no positive number");
}

}  // namespace
}  // namespace nlos
