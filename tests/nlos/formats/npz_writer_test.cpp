// SPDX-License-Identifier: MIT
// What stands in .npz files, read by libzip and byte by byte.
#include "nlos/containers/writers/npz_writer.h"

#include "nlos/formats/capture_file.h"
#include "renderer/core/settings/json_file.h"
#include "renderer/core/system/output_file.h"
#include "tests/support/error_message.h"
#include "tests/support/example_capture.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>
#include <zip.h>

#include <cstring>
#include <filesystem>
#include <map>

namespace nlos {
namespace {

using core::Capture;
using core::ScanPattern;
using test_support::example_capture;
using test_support::TemporaryFolder;

/// One array: the dictionary of its header without blanks, and its values.
struct Member {
    std::string dictionary;
    std::string bytes;

    template <class T>
    std::vector<T> values() const {
        std::vector<T> read(bytes.size() / sizeof(T));
        std::memcpy(read.data(), bytes.data(), bytes.size());
        return read;
    }
    /// The characters of a text in ASCII.
    std::string text() const {
        std::string characters;
        for (const char32_t c : values<char32_t>()) characters += static_cast<char>(c);
        return characters;
    }
};

Member parse_npy(const std::string& file) {
    EXPECT_EQ(file.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
    const auto length = static_cast<std::size_t>(static_cast<unsigned char>(file[8])) +
                        256 * static_cast<std::size_t>(static_cast<unsigned char>(file[9]));
    EXPECT_EQ((10 + length) % 64, 0U);
    EXPECT_EQ(file[10 + length - 1], '\n');
    Member member;
    for (const char c : file.substr(10, length)) {
        if (c != ' ' && c != '\n') member.dictionary += c;
    }
    member.bytes = file.substr(10 + length);
    return member;
}

std::map<std::string, Member> unzip_npz(const std::string& path) {
    std::map<std::string, Member> members;
    zip_t* archive = zip_open(path.c_str(), ZIP_RDONLY | ZIP_CHECKCONS, nullptr);
    if (archive == nullptr) {
        ADD_FAILURE() << path << " is no zip archive";
        return members;
    }
    for (zip_int64_t i = 0; i < zip_get_num_entries(archive, 0); ++i) {
        const auto index = static_cast<zip_uint64_t>(i);
        zip_stat_t stat;
        zip_stat_index(archive, index, 0, &stat);
        EXPECT_EQ(stat.comp_method, ZIP_CM_DEFLATE);
        std::string bytes(stat.size, '\0');
        zip_file_t* file = zip_fopen_index(archive, index, 0);
        EXPECT_EQ(zip_fread(file, bytes.data(), stat.size), static_cast<zip_int64_t>(stat.size));
        EXPECT_EQ(zip_fclose(file), 0);
        const std::string name = stat.name;
        EXPECT_EQ(name.substr(name.size() - 4), ".npy");
        members[name.substr(0, name.size() - 4)] = parse_npy(bytes);
    }
    zip_close(archive);
    return members;
}

std::map<std::string, Member> write_and_unzip(const Capture& capture) {
    const TemporaryFolder folder;
    EXPECT_TRUE(write_capture(folder.file("a.npz"), capture).empty());
    return unzip_npz(folder.file("a.npz"));
}

std::string dictionary(const std::string& type, const std::string& shape) {
    return "{'descr':'" + type + "','fortran_order':False,'shape':" + shape + ",}";
}

/// [pair][bin] with the bin slowest.
std::vector<float> time_slowest(const core::Transient& transient) {
    std::vector<float> values;
    for (std::size_t bin = 0; bin < transient.num_bins(); ++bin) {
        for (std::size_t pair = 0; pair < transient.num_pairs(); ++pair) {
            values.push_back(transient.histogram(pair)[bin]);
        }
    }
    return values;
}

TEST(NpzWriter, HistogramsStandWithTimeSlowest) {
    const std::map<ScanPattern, std::string> grids{{ScanPattern::Confocal, "(5,3,2,)"},
                                                   {ScanPattern::Single, "(5,3,2,)"},
                                                   {ScanPattern::Exhaustive, "(5,2,2,3,2,)"}};
    const std::map<ScanPattern, std::string> lists{{ScanPattern::Confocal, "(5,6,)"},
                                                   {ScanPattern::Single, "(5,6,)"},
                                                   {ScanPattern::Exhaustive, "(5,4,6,)"}};
    for (const auto& [pattern, shape] : grids) {
        Capture capture = example_capture(pattern);
        auto members = write_and_unzip(capture);
        EXPECT_EQ(members["H"].dictionary, dictionary("<f4", shape));
        EXPECT_EQ(members["H"].values<float>(), time_slowest(capture.transient));
        EXPECT_EQ(members["pattern"].text(), enum_name(pattern));
        capture.scan.wall().sensing = test_support::as_list(capture.scan.wall().sensing);
        capture.scan.wall().illumination = test_support::as_list(capture.scan.wall().illumination);
        members = write_and_unzip(capture);
        EXPECT_EQ(members["H"].dictionary, dictionary("<f4", lists.at(pattern)));
        EXPECT_EQ(members["H"].values<float>(), time_slowest(capture.transient));
    }
}

TEST(NpzWriter, PointsAndAxisKeepEveryBit) {
    Capture capture = example_capture(ScanPattern::Single);
    capture.scan.wall().sensing.positions[4] = {0.1 + 1e-13, -1.0 / 3.0, 2e-9};
    capture.scan.wall().laser_position = {0.1, 0.2, 0.3};
    capture.scan.wall().opl_origin = core::OplOrigin::Device;
    capture.time_axis.opl_start_m = -0.1234567890123;
    capture.time_axis.bin_width_m = 0.00799446554;
    const auto members = write_and_unzip(capture);
    EXPECT_EQ(members.at("sensor_grid_xyz").dictionary, dictionary("<f8", "(3,2,3,)"));
    EXPECT_EQ(members.at("laser_grid_xyz").dictionary, dictionary("<f8", "(1,1,3,)"));
    const auto points = members.at("sensor_grid_xyz").values<double>();
    const auto normals = members.at("sensor_grid_normals").values<double>();
    for (std::size_t i = 0; i < 6; ++i) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto k = static_cast<Eigen::Index>(axis);
            EXPECT_EQ(points[3 * i + axis], capture.scan.wall().sensing.positions[i][k]);
            EXPECT_EQ(normals[3 * i + axis], capture.scan.wall().sensing.normals[i][k]);
        }
    }
    EXPECT_EQ(members.at("laser_xyz").values<double>(), (std::vector<double>{0.1, 0.2, 0.3}));
    EXPECT_EQ(members.at("t_start").dictionary, dictionary("<f8", "()"));
    EXPECT_EQ(members.at("t_start").values<double>(), std::vector<double>{-0.1234567890123});
    EXPECT_EQ(members.at("delta_t").values<double>(), std::vector<double>{0.00799446554});
    EXPECT_EQ(members.at("opl_origin").text(), "device");
}

TEST(NpzWriter, TextsAreUnicodeOfFourBytesPerCharacter) {
    Capture capture = example_capture(ScanPattern::Confocal);
    capture.unit = core::TransientUnit::Counts;
    capture.scene_info =
        core::Json{{"a", "\xc3\xbc \xe2\x82\xac \xf0\x9f\x98\x80"}};  // 2, 3 and 4 bytes
    const auto members = write_and_unzip(capture);
    EXPECT_EQ(members.at("unit").dictionary, dictionary("<U6", "()"));
    EXPECT_EQ(members.at("unit").text(), "counts");
    const std::u32string wanted = U"{\"a\":\"\u00fc \u20ac \U0001f600\"}";
    EXPECT_EQ(members.at("scene_info").dictionary, dictionary("<U13", "()"));
    EXPECT_EQ(members.at("scene_info").values<char32_t>(),
              std::vector<char32_t>(wanted.begin(), wanted.end()));
}

TEST(NpzWriter, WhatElseACaptureHoldsIsThere) {
    Capture capture = example_capture(ScanPattern::Exhaustive);
    EXPECT_FALSE(write_and_unzip(capture).contains("variance"));
    capture.observed.emplace(24, core::BinRange{0, 5});
    (*capture.observed)[7] = {1, 4};
    capture.transient.histogram(7)[0] = capture.transient.histogram(7)[4] = 0.0F;
    capture.counts_per_radiance = 77.5;
    capture.variance = capture.transient;
    capture.orders = {3, 11};
    capture.by_order = {capture.transient, capture.transient};
    for (float& value : capture.by_order[1].values()) value *= -0.37F;
    capture.sequence = core::FrameSequence{capture.by_order, 0.02, 0.04};
    std::vector<float> stack = time_slowest(capture.by_order[0]);
    const std::vector<float> second = time_slowest(capture.by_order[1]);
    stack.insert(stack.end(), second.begin(), second.end());
    const auto members = write_and_unzip(capture);
    EXPECT_EQ(members.at("counts_per_radiance").values<double>(), std::vector<double>{77.5});
    std::vector<int> bins(24, 0);
    bins.resize(48, 5);
    bins[7] = 1;
    bins[24 + 7] = 4;
    EXPECT_EQ(members.at("observed_bins").dictionary, dictionary("<i4", "(2,2,2,3,2,)"));
    EXPECT_EQ(members.at("observed_bins").values<int>(), bins);
    EXPECT_EQ(members.at("variance").values<float>(), time_slowest(capture.transient));
    EXPECT_EQ(members.at("orders").dictionary, dictionary("<i4", "(2,)"));
    EXPECT_EQ(members.at("orders").values<int>(), (std::vector<int>{3, 11}));
    EXPECT_EQ(members.at("H_by_order").dictionary, dictionary("<f4", "(2,5,2,2,3,2,)"));
    EXPECT_EQ(members.at("H_by_order").values<float>(), stack);
    EXPECT_EQ(members.at("frames").values<float>(), stack);
    EXPECT_EQ(members.at("gate_step_m").values<double>(), std::vector<double>{0.02});
    EXPECT_EQ(members.at("frame_s").values<double>(), std::vector<double>{0.04});
}

TEST(NpzWriter, NothingButItsTemporaryFileIsThereWhileItWrites) {
    const TemporaryFolder folder;
    NpzWriter file(folder.file("a.npz"));
    std::vector<std::string> seen;
    file.write_rows("H", {4, 2}, [&](std::size_t, std::size_t count, std::vector<float>& values) {
        values.assign(2 * count, 1.0F);
        for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
            seen.push_back(entry.path().string());
        }
    });
    file.finish();
    EXPECT_EQ(seen, std::vector<std::string>{core::partial_file_of(folder.file("a.npz"))});
}

TEST(NpzWriter, ImagesHaveNoGridsAndTheirCameraInSceneInfo) {
    const Capture image = test_support::example_image();
    const auto members = write_and_unzip(image);
    EXPECT_EQ(members.at("H").dictionary, dictionary("<f4", "(5,3,2,)"));
    EXPECT_FALSE(members.contains("sensor_grid_xyz"));
    EXPECT_NE(members.at("scene_info").text().find("\"camera\":"), std::string::npos);
}

TEST(NpzWriter, LargeArraysAreWrittenInPieces) {
    Capture capture = example_capture(ScanPattern::Single);
    capture.scan.wall().sensing = test_support::example_grid(40, 30);
    capture.time_axis.num_bins = 1000;  // 1.2 million values
    capture.transient = core::Transient(1200, 1000);
    float next = 0.0F;
    for (float& value : capture.transient.values()) value = next += 1.0F;
    EXPECT_EQ(write_and_unzip(capture).at("H").values<float>(), time_slowest(capture.transient));
}

TEST(NpzWriter, TheSameCaptureGivesTheSameBytes) {
    const TemporaryFolder folder;
    const Capture capture = example_capture(ScanPattern::Exhaustive);
    write_capture(folder.file("a.npz"), capture);
    write_capture(folder.file("b.npz"), capture);
    EXPECT_EQ(test_support::file_bytes(folder.file("a.npz")),
              test_support::file_bytes(folder.file("b.npz")));
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 2);
}

TEST(NpzWriter, VelocitiesAreSaidToBeLeftOut) {
    const TemporaryFolder folder;
    Capture capture = example_capture(ScanPattern::Single);
    core::VelocityHistogram velocity;
    velocity.axis.num_bins = 2;
    velocity.values = core::Transient(6, 2);
    capture.velocity = velocity;
    EXPECT_EQ(write_capture(folder.file("a.npz"), capture),
              std::vector<std::string>{"velocities are left out"});
}

}  // namespace
}  // namespace nlos
