// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string_view>

namespace nlos {

/// What stands around deflated bytes; either ends in a checksum of what they unpack to.
enum class DeflateFrame { Zlib, Gzip };

/// Unpacks the stream that `packed` begins with and holds its checksum against what came out.
///
/// take      is given what comes out, piece by piece
/// returns   how many bytes the stream has; nothing when it is damaged or cut short
std::optional<std::size_t> unpack(std::string_view packed,
                                  DeflateFrame frame,
                                  const std::function<void(std::string_view piece)>& take);

}  // namespace nlos
