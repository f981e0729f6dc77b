// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

namespace nlos {

/// Throws core::Failure, with both numbers, when the machine cannot give `bytes` of memory.
void require_memory(std::uint64_t bytes, const std::string& where);

}  // namespace nlos
