// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace nlos {

/// Numbers as a chunk of an HDF5 dataset holds them after the filters shuffle, deflate and
/// fletcher32.
///
/// numbers       their bytes
/// number_bytes  of each
/// level         of deflate, from 1 to 9; 0: neither shuffle nor deflate
std::string pack_chunk(const std::string& numbers, std::size_t number_bytes, int level);

}  // namespace nlos
