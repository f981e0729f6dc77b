// SPDX-License-Identifier: MIT
#include "renderer/core/large_memory.h"

#include <sys/mman.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <memory>

namespace core {

void use_huge_pages(void* memory, std::size_t num_bytes) {
    constexpr std::size_t kPage = std::size_t{1} << 21;
    std::size_t space = num_bytes;
    if (num_bytes < 2 * kPage || std::align(kPage, kPage, memory, space) == nullptr) return;
    ::madvise(memory, space / kPage * kPage, MADV_HUGEPAGE);
}

void keep_freed_memory() {
#ifdef __GLIBC__
    constexpr int kLargestReused = 1 << 25;  // bytes, the most that the allocator allows
    constexpr int kMostKept = 1 << 28;       // at the end of the heap
    ::mallopt(M_MMAP_THRESHOLD, kLargestReused);
    ::mallopt(M_TRIM_THRESHOLD, kMostKept);
#endif
}

}  // namespace core
