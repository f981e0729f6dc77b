// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace nlos {

/// Numbers as a chunk of an HDF5 dataset holds them after the filters shuffle and deflate.
///
/// numbers       their bytes
/// number_bytes  of each
/// level         of deflate, from 1 to 9; 0: as they are, no filters
std::string pack_chunk(const std::string& numbers, std::size_t number_bytes, int level);

}  // namespace nlos
