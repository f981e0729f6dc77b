// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/system/process.h"

#include <cstdint>

namespace nlos {

/// Deflate, the strongest compression in use, shrinks by less than 1032 to 1: what claims to be
/// larger than so many times what is stored is damaged.
inline constexpr std::uint64_t kLargestDeflateRatio = 1100;

using core::require_memory;

}  // namespace nlos
