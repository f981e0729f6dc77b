// SPDX-License-Identifier: MIT
#include "nlos/containers/hdf5_handle.h"

#include <hdf5.h>

#include <array>
#include <fstream>

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

void prepare_hdf5() {
    // The library's own clean-up at exit crashes after a file could not be closed (disk full).
    // Handles close everything, so nothing is left to clean up.
    H5dont_atexit();
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

}  // namespace nlos
