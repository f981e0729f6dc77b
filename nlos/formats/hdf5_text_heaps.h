// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace nlos {

/// Throws core::Error when a global heap of an HDF5 file, where texts of variable length are kept,
/// is damaged: the library takes the lengths in it for granted, and overruns memory or never ends.
/// source [HDF5Format], section III.E
void check_text_heaps(const std::string& path);

}  // namespace nlos
