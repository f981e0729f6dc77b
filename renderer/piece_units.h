// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/third_bounce_pieces.h"

#include <experimental/simd>

#include <bit>
#include <cmath>
#include <cstdint>

namespace renderer {

/// Some units of a block, runs of PieceBlock::kUnitSize lanes that lie next to each other: unit u
/// is bit u.
using UnitMask = std::uint32_t;

inline constexpr UnitMask kAllUnits = (UnitMask{1} << PieceBlock::kUnits) - 1;

/// A value per piece of a unit.
using UnitLanes = std::array<double, PieceBlock::kUnitSize>;

/// Calls work(first lane) for each unit.
template <class Work>
void for_each_unit(UnitMask units, const Work& work) {
    for (; units != 0; units &= units - 1) {
        work(static_cast<std::size_t>(std::countr_zero(units)) * PieceBlock::kUnitSize);
    }
}

/// The values of a unit's pieces, for arithmetic in vectors: compilers leave loops over lanes of
/// arrays in memory scalar where these might overlap.
using UnitArray = std::experimental::fixed_size_simd<double, PieceBlock::kUnitSize>;

/// Reads the lanes from `begin`, the first of a unit.
inline UnitArray load(const PieceBlock::Lanes& lanes, std::size_t begin) {
    return UnitArray(lanes.data() + begin, std::experimental::vector_aligned);
}

inline void store(const UnitArray& values, PieceBlock::Lanes& lanes, std::size_t begin) {
    values.copy_to(lanes.data() + begin, std::experimental::vector_aligned);
}

inline UnitArray larger_of(const UnitArray& a, const UnitArray& b) {
    return std::experimental::max(a, b);
}

inline UnitArray square_root(const UnitArray& a) {
    return UnitArray([&](auto i) { return std::sqrt(a[i]); });
}

}  // namespace renderer
