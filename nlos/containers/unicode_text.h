// SPDX-License-Identifier: MIT
#pragma once

#include <bit>
#include <cstddef>
#include <string>

namespace nlos {

/// Text of `count` units of 1, 2 or 4 bytes each (UTF-8, UTF-16, UTF-32) as UTF-8; what is no
/// character becomes U+FFFD.
std::string utf8_text(const char* units,
                      std::size_t count,
                      std::size_t unit_bytes,
                      std::endian order);

}  // namespace nlos
