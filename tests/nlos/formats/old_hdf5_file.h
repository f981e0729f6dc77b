// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/hdf5_handle.h"
#include "renderer/core/capture/capture.h"

#include <hdf5.h>

#include <string>
#include <vector>

namespace nlos {

/// Writes the datasets that reading a capture needs in HDF5's oldest format, as h5py does by
/// default: its headers have no checksums, and the library crashes on some damaged ones.
inline void write_old_hdf5(const std::string& path, const core::Capture& capture) {
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_libver_bounds(access, H5F_LIBVER_EARLIEST, H5F_LIBVER_V18);
    const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
    const auto write = [&](const char* name, std::vector<hsize_t> shape, const void* values) {
        const hid_t space = H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr);
        const hid_t plan = H5Pcreate(H5P_DATASET_CREATE);
        if (shape.size() > 1) {
            H5Pset_chunk(plan, static_cast<int>(shape.size()), shape.data());
            H5Pset_deflate(plan, 4);
        }
        const hid_t set =
            H5Dcreate2(file, name, H5T_NATIVE_FLOAT, space, H5P_DEFAULT, plan, H5P_DEFAULT);
        H5Dwrite(set, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
        H5Dclose(set);
        H5Pclose(plan);
        H5Sclose(space);
    };
    const auto write_points = [&](const char* name, const core::WallPoints& points) {
        std::vector<float> values;
        for (const core::Vec3& position : points.positions) {
            for (const double coordinate : position) {
                values.push_back(static_cast<float>(coordinate));
            }
        }
        write(name, {points.size(), 3}, values.data());
    };
    write_points("sensor_grid_xyz", capture.scan.wall().sensing);
    write_points("laser_grid_xyz", capture.scan.wall().illumination);
    const auto bins = static_cast<std::size_t>(capture.time_axis.num_bins);
    std::vector<float> h(capture.transient.values().size());
    for (std::size_t pair = 0; pair < capture.transient.num_pairs(); ++pair) {
        for (std::size_t bin = 0; bin < bins; ++bin) {
            h[bin * capture.transient.num_pairs() + pair] = capture.transient.histogram(pair)[bin];
        }
    }
    std::vector<hsize_t> shape{bins};
    if (capture.scan.wall().pattern == core::ScanPattern::Exhaustive) {
        shape.push_back(capture.scan.wall().illumination.size());
    }
    shape.push_back(capture.scan.wall().sensing.size());
    write("H", shape, h.data());
    const auto width = static_cast<float>(capture.time_axis.bin_width_m);
    write("delta_t", {1}, &width);

    const hid_t text = H5Tcopy(H5T_C_S1);
    H5Tset_size(text, H5T_VARIABLE);
    const hid_t scalar = H5Screate(H5S_SCALAR);
    const hid_t set =
        H5Dcreate2(file, "scene_info", text, scalar, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    const char* characters = "{\"seed\": 7}";
    H5Dwrite(set, text, H5S_ALL, H5S_ALL, H5P_DEFAULT, &characters);
    H5Dclose(set);
    H5Sclose(scalar);
    H5Tclose(text);
    H5Fclose(file);
    H5Pclose(access);
}

}  // namespace nlos
