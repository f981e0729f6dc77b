// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"

#include <cmath>

// Truth for the hard cases: closed forms of the design, written out once more in numbers of 113
// bits. Their rounding, 1e-34, stays below that of a double through condition numbers of 1e18.

namespace truth {

__extension__ using Quad = __float128;

// Of libquadmath; its header belongs to one compiler.
extern "C" {
Quad sqrtq(Quad) noexcept;
Quad expq(Quad) noexcept;
Quad expm1q(Quad) noexcept;
Quad log1pq(Quad) noexcept;
Quad erfcq(Quad) noexcept;
Quad sinq(Quad) noexcept;
Quad cosq(Quad) noexcept;
Quad atan2q(Quad, Quad) noexcept;
Quad floorq(Quad) noexcept;
}

inline Quad pi() {
    return 4 * atan2q(1, 1);
}
inline Quad abs(Quad x) {
    return x < 0 ? -x : x;
}
inline double to_double(Quad x) {
    return static_cast<double>(x);
}

/// A point or direction.
struct QuadVec {
    Quad x = 0, y = 0, z = 0;

    QuadVec() = default;
    QuadVec(Quad x_, Quad y_, Quad z_) : x(x_), y(y_), z(z_) {}
    QuadVec(const core::Vec3& v) : x(v.x()), y(v.y()), z(v.z()) {}  // NOLINT: meant to convert

    Quad dot(const QuadVec& v) const { return x * v.x + y * v.y + z * v.z; }
    QuadVec cross(const QuadVec& v) const {
        return {y * v.z - z * v.y, z * v.x - x * v.z, x * v.y - y * v.x};
    }
    Quad norm() const { return sqrtq(dot(*this)); }
    QuadVec normalized() const {
        const Quad n = norm();
        return {x / n, y / n, z / n};
    }
};
inline QuadVec operator+(const QuadVec& a, const QuadVec& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline QuadVec operator-(const QuadVec& a, const QuadVec& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline QuadVec operator*(Quad s, const QuadVec& v) {
    return {s * v.x, s * v.y, s * v.z};
}

/// |found - expected| / scale, infinite when it is no number.
inline double relative_error(Quad found, Quad expected, Quad scale) {
    const double error = to_double(abs(found - expected) / abs(scale));
    return error >= 0.0 ? error : HUGE_VAL;
}
/// Relative to the expected value; 0 when both are 0.
inline double relative_error(Quad found, Quad expected) {
    return found == expected ? 0.0 : relative_error(found, expected, expected);
}
inline double relative_error(const core::Vec3& found, const QuadVec& expected, Quad scale) {
    return relative_error((QuadVec(found) - expected).norm(), 0, scale);
}

}  // namespace truth
