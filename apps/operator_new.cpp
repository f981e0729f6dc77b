// SPDX-License-Identifier: MIT
// The program's own `new`: large blocks stand in huge pages.
#include "renderer/core/system/large_memory.h"

#include <cstdlib>
#include <new>

void* operator new(std::size_t num_bytes) {
    void* const memory = std::malloc(num_bytes > 0 ? num_bytes : 1);
    if (memory == nullptr) throw std::bad_alloc();
    core::use_huge_pages(memory, num_bytes);
    return memory;
}

void operator delete(void* memory) noexcept {
    std::free(memory);
}

void operator delete(void* memory, std::size_t /*num_bytes*/) noexcept {
    std::free(memory);
}
