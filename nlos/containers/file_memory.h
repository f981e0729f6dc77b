// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

namespace nlos {

/// Deflate, the strongest compression in use, shrinks by less than 1032 to 1: what claims to be
/// larger than so many times what is stored is damaged.
inline constexpr std::uint64_t kLargestDeflateRatio = 1100;

/// Throws core::Failure, with both numbers, when the machine cannot give `bytes` of memory.
void require_memory(std::uint64_t bytes, const std::string& where);

}  // namespace nlos
