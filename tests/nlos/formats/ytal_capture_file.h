// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/writers/hdf5_writer.h"
#include "nlos/formats/capture_file.h"
#include "tests/support/temporary_folder.h"

#include <gtest/gtest.h>
#include <hdf5.h>

#include <algorithm>
#include <string>
#include <vector>

namespace nlos {

inline void expect_same_points(const core::WallPoints& a, const core::WallPoints& b) {
    ASSERT_EQ(a.size(), b.size());
    EXPECT_EQ(a.grid, b.grid);
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_LT((a.positions[i] - b.positions[i]).norm(), 1e-6);
        EXPECT_LT((a.normals[i] - b.normals[i]).norm(), 1e-7);
    }
}

inline void expect_same(const core::Capture& a, const core::Capture& b) {
    ASSERT_EQ(a.scan.has_wall(), b.scan.has_wall());
    EXPECT_EQ(a.scan.pattern(), b.scan.pattern());
    EXPECT_EQ(a.scan.opl_origin(), b.scan.opl_origin());
    EXPECT_LT((a.scan.devices().laser - b.scan.devices().laser).norm(), 1e-7);
    EXPECT_LT((a.scan.devices().detector - b.scan.devices().detector).norm(), 1e-7);
    if (a.scan.has_wall()) {
        expect_same_points(a.scan.wall().sensing, b.scan.wall().sensing);
        expect_same_points(a.scan.wall().illumination, b.scan.wall().illumination);
    }
    EXPECT_EQ(a.time_axis.opl_start_m, b.time_axis.opl_start_m);
    EXPECT_EQ(a.time_axis.bin_width_m, b.time_axis.bin_width_m);
    ASSERT_EQ(a.transient.num_pairs(), b.transient.num_pairs());
    EXPECT_TRUE(std::ranges::equal(a.transient.values(), b.transient.values()));
    EXPECT_EQ(a.unit, b.unit);
    EXPECT_EQ(*a.scene_info, *b.scene_info);
    ASSERT_EQ(a.variance.has_value(), b.variance.has_value());
    if (a.variance) {
        EXPECT_TRUE(std::ranges::equal(a.variance->values(), b.variance->values()));
    }
}

/// 0, 1, 2, ...
inline std::vector<float> ramp(std::size_t count) {
    std::vector<float> values;
    for (std::size_t i = 0; i < count; ++i) values.push_back(static_cast<float>(i));
    return values;
}

/// A written capture whose datasets a test replaces through the HDF5 library itself.
class CaptureFile {
 public:
    explicit CaptureFile(const core::Capture& capture) : path_(folder_.file("capture.h5")) {
        write_capture(path_, capture);
    }

    const std::string& path() const { return path_; }
    core::Capture read() const { return read_capture(path_); }

    void remove(const char* name) const {
        edit([&](hid_t file) { H5Ldelete(file, name, H5P_DEFAULT); });
    }

    template <class T>
    void replace(const char* name,
                 hid_t type,
                 const Shape& shape,
                 const std::vector<T>& values) const {
        const std::vector<hsize_t> extents(shape.begin(), shape.end());
        edit([&](hid_t file) {
            H5Ldelete(file, name, H5P_DEFAULT);
            const hid_t space =
                extents.empty()
                    ? H5Screate(H5S_SCALAR)
                    : H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr);
            const hid_t set =
                H5Dcreate2(file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
            H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
            H5Dclose(set);
            H5Sclose(space);
        });
    }

    /// y-tal's "None".
    void replace_by_none(const char* name) const {
        edit([&](hid_t file) {
            H5Ldelete(file, name, H5P_DEFAULT);
            const hid_t space = H5Screate(H5S_NULL);
            H5Dclose(H5Dcreate2(
                file, name, H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
            H5Sclose(space);
        });
    }

    template <class Action>
    void edit(Action&& action) const {
        const hid_t file = H5Fopen(path_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
        action(file);
        H5Fclose(file);
    }

 private:
    test_support::TemporaryFolder folder_;
    std::string path_;
};

}  // namespace nlos
