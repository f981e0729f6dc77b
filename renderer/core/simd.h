// SPDX-License-Identifier: MIT
#pragma once

#include <experimental/simd>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

// A function call would pass these values through memory instead of registers.
#define NLOS_INLINE [[gnu::always_inline]] inline

namespace core {

/// Eight doubles in SIMD registers of the processor's native width.
///
/// Compilers do not vectorize loops over arrays that may alias, nor loops with conditions. The
/// standard library's fixed-size vectors are slow where they take several registers, and with GCC
/// 12 comparisons of them then go wrong. Functions that compute with Simd should be inlined, too.
struct Simd {
    using Part = std::experimental::native_simd<double>;
    static constexpr std::size_t kParts = 8 / Part::size();
    static constexpr std::size_t size() { return kParts * Part::size(); }

    std::array<Part, kParts> parts;

    Simd() = default;
    NLOS_INLINE Simd(double value) {
        for (Part& part : parts) part = value;
    }
    double operator[](std::size_t i) const { return parts[i / Part::size()][i % Part::size()]; }
};

/// A condition per lane.
struct SimdMask {
    using Part = Simd::Part::mask_type;

    std::array<Part, Simd::kParts> parts;

    NLOS_INLINE bool any() const {
        bool found = false;
        for (const Part& part : parts) found |= any_of(part);
        return found;
    }
    /// Lane i as bit i.
    NLOS_INLINE std::uint64_t bits() const {
        std::uint64_t bits = 0;
        for (std::size_t i = 0; i < Simd::size(); ++i) {
            bits |= std::uint64_t{parts[i / Part::size()][i % Part::size()]} << i;
        }
        return bits;
    }
};

/// Reads the lanes from `begin`, a multiple of Simd::size(), of an array aligned to 64 bytes.
template <std::size_t N>
NLOS_INLINE Simd load(const std::array<double, N>& lanes, std::size_t begin) {
    Simd values;
    for (std::size_t p = 0; p < Simd::kParts; ++p) {
        values.parts[p].copy_from(lanes.data() + begin + p * Simd::Part::size(),
                                  std::experimental::vector_aligned);
    }
    return values;
}

/// The reverse of load().
template <std::size_t N>
NLOS_INLINE void store(const Simd& values, std::array<double, N>& lanes, std::size_t begin) {
    for (std::size_t p = 0; p < Simd::kParts; ++p) {
        values.parts[p].copy_to(lanes.data() + begin + p * Simd::Part::size(),
                                std::experimental::vector_aligned);
    }
}

// A function whose result's native vectors follow one by one from those of its arguments.
#define NLOS_BY_PART(Result, signature, part)                                  \
    NLOS_INLINE Result signature {                                             \
        Result result;                                                         \
        for (std::size_t p = 0; p < Simd::kParts; ++p) result.parts[p] = part; \
        return result;                                                         \
    }
NLOS_BY_PART(Simd, operator+(const Simd& a, const Simd& b), a.parts[p] + b.parts[p])
NLOS_BY_PART(Simd, operator-(const Simd& a, const Simd& b), a.parts[p] - b.parts[p])
NLOS_BY_PART(Simd, operator*(const Simd& a, const Simd& b), a.parts[p] * b.parts[p])
NLOS_BY_PART(Simd, operator/(const Simd& a, const Simd& b), a.parts[p] / b.parts[p])
NLOS_BY_PART(Simd, operator-(const Simd& a), -a.parts[p])
NLOS_BY_PART(Simd, max(const Simd& a, const Simd& b), max(a.parts[p], b.parts[p]))
NLOS_BY_PART(Simd, min(const Simd& a, const Simd& b), min(a.parts[p], b.parts[p]))
NLOS_BY_PART(Simd, floor(const Simd& a), floor(a.parts[p]))
NLOS_BY_PART(SimdMask, operator<(const Simd& a, const Simd& b), a.parts[p] < b.parts[p])
NLOS_BY_PART(SimdMask, operator<=(const Simd& a, const Simd& b), a.parts[p] <= b.parts[p])
NLOS_BY_PART(SimdMask, operator!=(const Simd& a, const Simd& b), a.parts[p] != b.parts[p])
NLOS_BY_PART(SimdMask, operator&(const SimdMask& a, const SimdMask& b), a.parts[p] && b.parts[p])
NLOS_BY_PART(SimdMask, operator!(const SimdMask& a), !a.parts[p])
// Lane by lane, which compilers vectorize: with the library's own square root some warn of
// uninitialized memory in it.
NLOS_BY_PART(Simd, sqrt(const Simd& a), Simd::Part([&](auto i) {
                 return std::sqrt(a.parts[p][i]);
             }))
#undef NLOS_BY_PART

NLOS_INLINE Simd& operator+=(Simd& a, const Simd& b) {
    return a = a + b;
}
NLOS_INLINE Simd& operator*=(Simd& a, const Simd& b) {
    return a = a * b;
}

/// The same of single numbers, for templates of both.
NLOS_INLINE double sqrt(double a) {
    return std::sqrt(a);
}
NLOS_INLINE double max(double a, double b) {
    return a < b ? b : a;
}

/// By lane: a where the mask holds, else b.
NLOS_INLINE Simd select(const SimdMask& mask, const Simd& a, const Simd& b) {
    Simd result = b;
    for (std::size_t p = 0; p < Simd::kParts; ++p) {
        where(mask.parts[p], result.parts[p]) = a.parts[p];
    }
    return result;
}

NLOS_INLINE double sum_of(const Simd& a) {
    Simd::Part result = a.parts[0];
    for (std::size_t p = 1; p < Simd::kParts; ++p) result = result + a.parts[p];
    return reduce(result);
}

NLOS_INLINE double reduce_min(const Simd& a) {
    Simd::Part result = a.parts[0];
    for (std::size_t p = 1; p < Simd::kParts; ++p) result = min(result, a.parts[p]);
    return hmin(result);
}

NLOS_INLINE double reduce_max(const Simd& a) {
    Simd::Part result = a.parts[0];
    for (std::size_t p = 1; p < Simd::kParts; ++p) result = max(result, a.parts[p]);
    return hmax(result);
}

}  // namespace core

#undef NLOS_INLINE
