// SPDX-License-Identifier: MIT
#include "nlos/containers/hdf5_handle.h"

#include <hdf5.h>

#include <array>
#include <fstream>
#include <vector>

namespace nlos {

static_assert(std::is_same_v<hid_t, std::int64_t>, "Hdf5Handle stores HDF5 identifiers");

bool is_hdf5_file(const std::string& path) {
    constexpr std::array<char, 8> kSignature{'\x89', 'H', 'D', 'F', '\r', '\n', '\x1a', '\n'};
    constexpr std::streamoff kFirstUserBlock = 512;
    std::ifstream file(path, std::ios::binary);
    // A block for others may stand before the file proper: 512 bytes, 1024, 2048, ...
    for (std::streamoff begin = 0;; begin = begin == 0 ? kFirstUserBlock : 2 * begin) {
        std::array<char, 8> start{};
        if (!file.seekg(begin).read(start.data(), start.size())) return false;
        if (start == kSignature) return true;
    }
}

Hdf5Handle select_rows(const Hdf5Handle& space, std::size_t first, std::size_t count) {
    const int rank = H5Sget_simple_extent_ndims(space.id());
    std::vector<hsize_t> start(static_cast<std::size_t>(rank), 0);
    std::vector<hsize_t> size(start.size());
    if (rank > 0) {
        H5Sget_simple_extent_dims(space.id(), size.data(), nullptr);
        start[0] = first;
        size[0] = count;
        H5Sselect_hyperslab(
            space.id(), H5S_SELECT_SET, start.data(), nullptr, size.data(), nullptr);
    }
    return {H5Screate_simple(rank, size.data(), nullptr), H5Sclose};
}

void prepare_hdf5() {
    // The library's own clean-up at exit crashes after a file could not be closed (disk full).
    // Handles close everything, so nothing is left to clean up.
    H5dont_atexit();
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

}  // namespace nlos
