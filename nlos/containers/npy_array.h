// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/containers/stored_array.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace nlos {

/// What the head of a .npy file says of its array.
struct NpyHeader {
    StoredArray array;  ///< without bytes; of a kind of its own where it holds no numbers
    std::uint64_t value_bytes = 0;
    std::size_t unit_bytes = 1;  ///< of the characters of texts: 1 or 4
    bool is_pickle = false;
    std::size_t data_begin = 0;  ///< where the values start in the file
};

/// How many bytes of a file parse_npy_header() needs at most; a longer head is refused.
inline constexpr std::size_t kLongestNpyHeader = 66'000;

/// True when bytes start like those of a .npy file.
bool is_npy(std::string_view bytes);

/// Reads the head of a .npy file.
///
/// start     the file's first bytes, kLongestNpyHeader of them if there are as many
/// num_bytes  size of the whole file, against which the shape is checked
/// where      for messages
/// throws     core::Error when it is damaged or the file is cut short
NpyHeader parse_npy_header(std::string_view start,
                           std::uint64_t num_bytes,
                           const std::string& where);

/// What an array is; its text when it is one. `data` holds its values.
ArrayDescription describe_npy(const NpyHeader& header, std::string_view data);

}  // namespace nlos
