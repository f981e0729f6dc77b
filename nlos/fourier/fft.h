// SPDX-License-Identifier: MIT
#pragma once

#include <complex>
#include <cstddef>
#include <memory>

namespace nlos {

using ComplexF = std::complex<float>;

/// The smallest product of 2, 3, 5 and 7 that is at least `n`; transforms of such lengths are fast.
std::size_t good_fft_size(std::size_t n);

/// Floats from one row of `num_floats` to the next: neighbours lie in different cache sets, so that
/// a walk down the rows does not throw out what it read.
inline std::size_t row_stride(std::size_t num_floats) {
    constexpr std::size_t kLine = 16;  // floats
    const std::size_t lines = (num_floats + kLine - 1) / kLine;
    return kLine * (lines | 1U);
}

/// The same of rows of complex numbers, counted in these.
inline std::size_t complex_row_stride(std::size_t count) {
    return row_stride(2 * count) / 2;
}

/// How many transforms to ask for where `count` are needed and room for a few more is there: FFTW
/// uses its widest vectors for whole fours alone, which makes 68 faster than 65.
inline std::size_t in_fours(std::size_t count) {
    return (count + 3) / 4 * 4;
}

/// Memory aligned for transforms, zeroed at the start: the system does it page by page, in the
/// thread that comes to a page first. Large buffers ask for huge pages.
class FftBuffer {
 public:
    explicit FftBuffer(std::size_t num_floats);

    float* data() { return data_; }
    ComplexF* complex() { return reinterpret_cast<ComplexF*>(data_); }
    std::size_t num_floats() const { return num_floats_; }

 private:
    struct Free {
        void operator()(void* memory) const;
    };
    std::size_t num_floats_;
    std::unique_ptr<void, Free> memory_;
    float* data_;  ///< the first aligned float of it
};

/// Single-precision transforms, planned once and safe to run from several threads on buffers of
/// their own. Plans are estimated, never measured: the same bits in every run.
/// Nothing is normalised.
class Fft {
 public:
    enum class Direction { Forward, Inverse };

    /// `count` rows of `length` real numbers become rows of `length / 2 + 1` complex numbers in
    /// another buffer, and back; length even. FFTW takes a multiple of the time to plan those in
    /// place. Complex rows are not kept.
    static Fft real_to_complex(std::size_t length, std::size_t count);
    static Fft complex_to_real(std::size_t length, std::size_t count);

    /// Floats from one such row to the next.
    static std::size_t row_floats(std::size_t length) { return row_stride(length + 2); }

    /// Element i of transform j stands at i * stride + j * distance.
    struct Layout {
        std::size_t stride, distance;
    };
    /// `count` complex transforms of `length` numbers, in place or from one buffer to another.
    static Fft complex_batch(std::size_t length,
                             std::size_t count,
                             const Layout& layout,
                             Direction direction);
    static Fft complex_batch(std::size_t length,
                             std::size_t count,
                             const Layout& from,
                             const Layout& to,
                             Direction direction);

    /// In place, as only complex transforms are.
    void run(FftBuffer& buffer) const { run(buffer, buffer); }
    void run(FftBuffer& from, FftBuffer& to) const;

 private:
    enum class Kind { RealToComplex, ComplexToReal, Complex };
    struct Destroy {
        void operator()(void* plan) const;
    };
    Fft(Kind kind, void* plan) : kind_(kind), plan_(plan) {}

    Kind kind_;
    std::unique_ptr<void, Destroy> plan_;
};

}  // namespace nlos
