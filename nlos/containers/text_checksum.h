// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

namespace nlos {

// HDF5 keeps texts of any length in a heap without a checksum. Files of ours state one beside those
// from which numbers are read: of a dataset's text the attribute `crc32` of the dataset, of a text
// attribute NAME the attribute NAME_crc32.

inline constexpr const char* kTextChecksum = "crc32";

/// The attribute that states the checksum of a text attribute.
inline std::string checksum_attribute(const std::string& name) {
    return name + "_" + kTextChecksum;
}

/// CRC-32 of a text's bytes, as zlib counts it.
double text_checksum(std::string_view text);

}  // namespace nlos
