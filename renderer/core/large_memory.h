// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>

namespace core {

/// Asks for huge pages where a block holds several; without effect where the system has none. The
/// first touch of every small page, and walks across many, take as long as the work on them.
void use_huge_pages(void* memory, std::size_t num_bytes);

/// Has the process keep most of the memory that it frees for what it needs next, instead of giving
/// it back and asking anew.
void keep_freed_memory();

}  // namespace core
