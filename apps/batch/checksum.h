// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace apps {

/// The checksum of a file's first `most_bytes`, XXH3 of 128 bits as `xxh128sum` prints it; nothing
/// when the file cannot be read.
std::optional<std::string> file_checksum(
    const std::string& path, std::uint64_t most_bytes = std::numeric_limits<std::uint64_t>::max());

/// The same of a text.
std::string text_checksum(std::string_view text);

}  // namespace apps
