// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/simd.h"
#include "renderer/core/types.h"

#include <array>
#include <cstddef>

namespace renderer {

/// A vector per SIMD lane.
struct SimdVec3 {
    core::Simd x, y, z;

    [[gnu::always_inline]] core::Simd dot(const core::Vec3& v) const {
        return x * v.x() + y * v.y() + z * v.z();
    }
    [[gnu::always_inline]] core::Simd dot(const SimdVec3& v) const {
        return x * v.x + y * v.y + z * v.z;
    }
};

/// Vectors side by side: one array per coordinate.
template <std::size_t N>
struct alignas(64) Vec3Lanes {
    std::array<double, N> x, y, z;

    core::Vec3 operator[](std::size_t i) const { return {x[i], y[i], z[i]}; }
    void set(std::size_t i, const core::Vec3& v) {
        x[i] = v.x();
        y[i] = v.y();
        z[i] = v.z();
    }
    /// The vectors from lane `begin` on, see core::load().
    [[gnu::always_inline]] SimdVec3 load(std::size_t begin) const {
        return {core::load(x, begin), core::load(y, begin), core::load(z, begin)};
    }
    /// The same, relative to `origin`.
    [[gnu::always_inline]] SimdVec3 load(std::size_t begin, const core::Vec3& origin) const {
        return {core::load(x, begin) - origin.x(),
                core::load(y, begin) - origin.y(),
                core::load(z, begin) - origin.z()};
    }
    /// The reverse of load().
    [[gnu::always_inline]] void store(const SimdVec3& v, std::size_t begin) {
        core::store(v.x, x, begin);
        core::store(v.y, y, begin);
        core::store(v.z, z, begin);
    }
};

}  // namespace renderer
