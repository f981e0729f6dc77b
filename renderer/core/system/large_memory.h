// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

namespace core {

/// Asks for huge pages where a block holds several; without effect where the system has none. The
/// first touch of every small page, and walks across many, take as long as the work on them.
void use_huge_pages(void* memory, std::size_t num_bytes);

/// `count` zeros. All threads allowed bring their pages into memory, which would keep one busy for
/// a good part of the work that follows.
std::vector<float> zeros(std::size_t count);

/// Has the process keep most of the memory that it frees for what it needs next, instead of giving
/// it back and asking anew.
void keep_freed_memory();

}  // namespace core
