// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/third_bounce/surface_elements.h"

#include <bit>
#include <cstdint>

namespace renderer {

/// A set of SIMD groups of a block, runs of ElementBlock::kSimdWidth consecutive lanes: group u is
/// bit u.
using SimdGroupMask = std::uint32_t;

inline constexpr SimdGroupMask kAllSimdGroups =
    (SimdGroupMask{1} << ElementBlock::kNumSimdGroups) - 1;

/// Calls work(i) for each bit i that is set, in order.
template <class Work>
void for_each_bit(std::uint64_t bits, const Work& work) {
    for (; bits != 0; bits &= bits - 1) work(static_cast<std::size_t>(std::countr_zero(bits)));
}

/// Calls work(first lane) for each SIMD group.
template <class Work>
void for_each_simd_group(SimdGroupMask simd_groups, const Work& work) {
    for_each_bit(simd_groups,
                 [&](std::size_t simd_group) { work(simd_group * ElementBlock::kSimdWidth); });
}

}  // namespace renderer
