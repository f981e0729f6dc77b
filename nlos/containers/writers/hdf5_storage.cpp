// SPDX-License-Identifier: MIT
#include "nlos/containers/writers/hdf5_storage.h"

#include <hdf5.h>

#include <algorithm>
#include <limits>
#include <vector>

namespace nlos {
namespace {

constexpr std::uint64_t kMostInHeader = 60'000;  // bytes; messages in headers have at most 65,536
constexpr std::uint64_t kChunkBytes = std::uint64_t{1} << 20;

/// The extents of chunks of about kChunkBytes, evenly cut: whole along the fastest axes.
Shape chunk_of(Shape shape, std::size_t value_bytes) {
    std::uint64_t bytes = total_bytes(shape, value_bytes);
    for (std::size_t& extent : shape) {
        if (bytes <= kChunkBytes) break;
        const std::uint64_t row = bytes / extent;
        const std::uint64_t most = std::max<std::uint64_t>(1, kChunkBytes / row);
        const std::uint64_t pieces = (extent + most - 1) / most;
        extent = (extent + pieces - 1) / pieces;
        bytes = row * extent;
    }
    return shape;
}

}  // namespace

Hdf5Handle plain_creation() {
    Hdf5Handle plan(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_obj_track_times(plan.id(), false);
    return plan;
}

Hdf5Handle guarded_creation(std::int64_t type, const Shape& shape) {
    Hdf5Handle plan = plain_creation();
    const std::size_t value_bytes = H5Tget_size(type);
    if (total_bytes(shape, value_bytes) <= kMostInHeader) {
        H5Pset_layout(plan.id(), H5D_COMPACT);
        return plan;
    }
    const Shape chunk = chunk_of(shape, value_bytes);
    const std::vector<hsize_t> extents(chunk.begin(), chunk.end());
    H5Pset_chunk(plan.id(), static_cast<int>(extents.size()), extents.data());
    H5Pset_fletcher32(plan.id());
    if (H5Tget_class(type) == H5T_FLOAT) {
        constexpr double kNowhere = std::numeric_limits<double>::infinity();
        H5Pset_fill_value(plan.id(), H5T_NATIVE_DOUBLE, &kNowhere);
    }
    return plan;
}

std::size_t rows_of_write(const Shape& shape, std::size_t value_bytes) {
    constexpr std::uint64_t kBytesPerWrite = std::uint64_t{1} << 24;
    const std::uint64_t rows = chunk_of(shape, value_bytes)[0];
    const std::uint64_t bytes = rows * values_per_row(shape) * value_bytes;
    return rows * std::max<std::uint64_t>(1, kBytesPerWrite / std::max<std::uint64_t>(1, bytes));
}

}  // namespace nlos
