// SPDX-License-Identifier: MIT
#include "renderer/core/system/large_memory.h"

#include "renderer/core/system/parallel.h"

#include <sys/mman.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <memory>
#include <span>

namespace core {
namespace {

constexpr std::size_t kPage = std::size_t{1} << 21;  // a huge one

/// The whole huge pages of a block that holds several.
std::span<std::byte> huge_pages(void* memory, std::size_t num_bytes) {
    std::size_t space = num_bytes;
    if (num_bytes < 2 * kPage || std::align(kPage, kPage, memory, space) == nullptr) return {};
    return {static_cast<std::byte*>(memory), space / kPage * kPage};
}

}  // namespace

void use_huge_pages(void* memory, std::size_t num_bytes) {
    const std::span<std::byte> pages = huge_pages(memory, num_bytes);
    if (!pages.empty()) ::madvise(pages.data(), pages.size(), MADV_HUGEPAGE);
}

std::vector<float> zeros(std::size_t count) {
    std::vector<float> values;
    values.reserve(count);
    use_huge_pages(values.data(), count * sizeof(float));
#ifdef MADV_POPULATE_WRITE  // no more than a wish: the pages come at the first touch otherwise
    const std::span<std::byte> pages = huge_pages(values.data(), count * sizeof(float));
    parallel_for(pages.size() / kPage, [&](std::size_t i) {
        ::madvise(pages.data() + i * kPage, kPage, MADV_POPULATE_WRITE);
    });
#endif
    values.resize(count);
    return values;
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
