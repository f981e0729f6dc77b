// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/third_bounce/third_bounce_pieces.h"

#include <bit>
#include <cstdint>

namespace renderer {

/// Some units of a block, runs of PieceBlock::kUnitSize lanes that lie next to each other: unit u
/// is bit u.
using UnitMask = std::uint32_t;

inline constexpr UnitMask kAllUnits = (UnitMask{1} << PieceBlock::kUnits) - 1;

/// A value per piece of a unit.
using UnitLanes = std::array<double, PieceBlock::kUnitSize>;

/// Three coordinates per piece of a unit.
struct UnitPoints {
    core::Simd x, y, z;

    [[gnu::always_inline]] core::Simd dot(const core::Vec3& v) const {
        return x * v.x() + y * v.y() + z * v.z();
    }
    [[gnu::always_inline]] core::Simd dot(const UnitPoints& v) const {
        return x * v.x + y * v.y + z * v.z;
    }
};

/// Points of a unit's pieces, the first of them in lane `begin`, relative to `origin`.
template <std::size_t N>
[[gnu::always_inline]] inline UnitPoints load_points(const std::array<double, N>& x,
                                                     const std::array<double, N>& y,
                                                     const std::array<double, N>& z,
                                                     std::size_t begin,
                                                     const core::Vec3& origin) {
    return {core::load(x, begin) - origin.x(),
            core::load(y, begin) - origin.y(),
            core::load(z, begin) - origin.z()};
}

/// Calls work(i) for each bit i that is set, in order.
template <class Work>
void for_each_bit(std::uint64_t bits, const Work& work) {
    for (; bits != 0; bits &= bits - 1) work(static_cast<std::size_t>(std::countr_zero(bits)));
}

/// Calls work(first lane) for each unit.
template <class Work>
void for_each_unit(UnitMask units, const Work& work) {
    for_each_bit(units, [&](std::size_t unit) { work(unit * PieceBlock::kUnitSize); });
}

}  // namespace renderer
