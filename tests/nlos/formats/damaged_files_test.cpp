// SPDX-License-Identifier: MIT
// Files of ours with a single bit turned: each is refused, or holds the same numbers.
#include "nlos/formats/capture_file.h"
#include "nlos/formats/volume_file.h"
#include "renderer/core/error.h"
#include "tests/support/example_capture.h"
#include "tests/support/example_reconstruction.h"
#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>

#include <functional>

namespace nlos {
namespace {

using core::Capture;
using test_support::TemporaryFolder;

/// Numbers one after the other, as bytes.
class Numbers {
 public:
    template <class T>
    void add(const T* values, std::size_t count) {
        bytes_.append(reinterpret_cast<const char*>(values), count * sizeof(T));
    }
    void add(double value) { add(&value, 1); }
    template <class T>
    void add(const std::vector<T>& values) {
        add(values.data(), values.size());
    }
    void add(const core::Transient& transient) {
        add(transient.values().data(), transient.values().size());
    }
    void add(const core::WallPoints& points) {
        for (const auto& list : {points.positions, points.normals}) {
            for (const core::Vec3& point : list) add(point.data(), 3);
        }
    }
    const std::string& bytes() const { return bytes_; }

 private:
    std::string bytes_;
};

std::string numbers_of(const Capture& capture) {
    Numbers numbers;
    numbers.add(capture.transient);
    numbers.add(capture.time_axis.opl_start_m);
    numbers.add(capture.time_axis.bin_width_m);
    numbers.add(capture.counts_per_radiance.value_or(0.0));
    numbers.add(static_cast<double>(capture.unit));
    if (capture.scan.has_wall()) {
        numbers.add(capture.scan.wall().sensing);
        numbers.add(capture.scan.wall().illumination);
    }
    if (capture.variance) numbers.add(*capture.variance);
    numbers.add(capture.orders);
    for (const core::Transient& order : capture.by_order) numbers.add(order);
    if (capture.observed) numbers.add(*capture.observed);
    if (capture.sequence) {
        for (const core::Transient& frame : capture.sequence->frames) numbers.add(frame);
        numbers.add(capture.sequence->frame_s);
    }
    return numbers.bytes() + capture.scene_info->dump();
}

std::string numbers_of(const Reconstruction& result) {
    Numbers numbers;
    numbers.add(result.volume.values);
    for (const auto* axis : {&result.volume.axes.x_m, &result.volume.axes.y_m}) numbers.add(*axis);
    numbers.add(result.volume.axes.z_m);
    numbers.add(result.volume.axes.world_from_wall.data(), 16);
    numbers.add(result.depth.depth_m);
    numbers.add(result.depth_sigma_m);
    numbers.add(result.surface_probability);
    for (const core::Vec3& point : result.points.positions) numbers.add(point.data(), 3);
    for (const core::Vec3& normal : result.points.normals) numbers.add(normal.data(), 3);
    numbers.add(result.settings.snr.value_or(0.0));
    return numbers.bytes();
}

/// Turns a bit of every so many bytes, one at a time.
/// read   the numbers of the file
void turn_bits(const std::string& path, const std::function<std::string()>& read) {
    constexpr std::size_t kMostCases = 100;
    const std::string bytes = test_support::file_bytes(path);
    const std::string numbers = read();
    const std::size_t step = std::max<std::size_t>(37, bytes.size() / kMostCases | 1U);
    std::size_t refused = 0;
    for (std::size_t i = step / 2; i < bytes.size(); i += step) {
        std::string damaged = bytes;
        damaged[i] = static_cast<char>(damaged[i] ^ (1 << i / step % 8));
        test_support::write_file_bytes(path, damaged);
        try {
            EXPECT_TRUE(read() == numbers) << path << ": byte " << i << " of " << bytes.size();
        } catch (const core::Error&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, 0U) << path;
    test_support::write_file_bytes(path, bytes);
    EXPECT_TRUE(read() == numbers) << path;
}

/// Large enough that not all is kept in headers: 16 x 16 points and 100 bins.
Capture large_square() {
    constexpr int kSide = 16;
    Capture capture;
    core::WallPoints points;
    points.grid = {kSide, kSide};
    for (int i = 0; i < kSide * kSide; ++i) {
        points.positions.emplace_back(
            0.01 * (2 * (i / kSide) - kSide + 1), 0.01 * (2 * (i % kSide) - kSide + 1), 0.0);
    }
    points.normals.assign(points.size(), core::Vec3::UnitZ());
    capture.scan.wall().sensing = points;
    capture.scan.wall().illumination = points;
    capture.time_axis = {0.125, 0.0047, 100};
    capture.transient = core::Transient(points.size(), 100);
    float next = 0.0F;
    for (float& value : capture.transient.values()) value = next += 3.5F;
    return capture;
}

/// With all that a file may hold beside the histograms.
Capture full(Capture capture) {
    capture.unit = core::TransientUnit::Counts;
    capture.counts_per_radiance = 12345.678;
    capture.variance = capture.transient;
    capture.orders = {3, 4};
    capture.by_order.assign(2, capture.transient);
    capture.sequence = core::FrameSequence{{capture.transient, capture.transient}, 0.02, 0.04};
    capture.scene_info["detector"] = {{"jitter_fwhm_ps", 60.0}, {"seed", 12345}};
    return capture;
}

TEST(DamagedFiles, OfCapturesAreRefusedOrTheSame) {
    const TemporaryFolder folder;
    const Capture small = test_support::example_capture(core::ScanPattern::Exhaustive);
    const auto expect_refusals = [&](const char* name, const Capture& capture) {
        const std::string path = folder.file(name);
        write_capture(path, capture);
        turn_bits(path, [&] { return numbers_of(read_capture(path)); });
    };
    for (const char* name : {"a.h5", "a.npz", "a.exr"}) {
        expect_refusals(name, small);
        expect_refusals(name, full(small));
        expect_refusals(name, large_square());
    }
    expect_refusals("image.exr", test_support::example_image());
}

TEST(DamagedFiles, OfMatlabAreRefusedOrTheSame) {
    const TemporaryFolder folder;
    const std::string path = folder.file("a.mat");
    for (const char* layout : {"stanford-2018", "stanford-fk-2019", "conv-nlos"}) {
        for (const Capture& capture : {test_support::example_square(), large_square()}) {
            write_capture(path, capture, {.layout = layout});
            turn_bits(path, [&] { return numbers_of(read_capture(path)); });
        }
    }
}

TEST(DamagedFiles, OfVolumesAreRefusedOrTheSame) {
    const TemporaryFolder folder;
    const std::string path = folder.file("v.h5");
    Reconstruction result = test_support::example_reconstruction();
    const auto expect_refusals = [&] {
        write_volume(path, result);
        turn_bits(path, [&] { return numbers_of(read_volume(path)); });
    };
    expect_refusals();
    VolumeAxes& axes = result.volume.axes;
    axes.x_m.resize(100);
    axes.y_m.resize(100);
    for (std::size_t i = 0; i < 100; ++i) axes.x_m[i] = axes.y_m[i] = 0.01 * static_cast<double>(i);
    result.volume.values.assign(axes.num_voxels(), 0.25F);
    result.volume.normals.assign(10000, Eigen::Vector3f(0.0F, 0.6F, -0.8F));
    result.depth = core::DepthMap(axes.x_m, axes.y_m);
    for (std::size_t i = 0; i < 10000; i += 3) result.depth.depth_m[i] = 0.6;
    result.depth_sigma_m.clear();
    result.surface_probability.clear();
    expect_refusals();
}

}  // namespace
}  // namespace nlos
