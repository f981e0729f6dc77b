// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

namespace nlos {

/// Throws core::Error when a global heap of an HDF5 file, where texts of variable length are kept,
/// is damaged: the library takes the lengths in it for granted, and overruns memory or never ends.
/// source [HDF5Format], section III.E
void check_text_heaps(const std::string& path);

/// Throws core::Error unless the text whose reference is stored at byte `position` of the file
/// exists.
void check_text_reference(const std::string& path, std::uint64_t position);

}  // namespace nlos
