// SPDX-License-Identifier: MIT
#pragma once

#include <complex>
#include <cstddef>
#include <memory>

namespace nlos {

using ComplexF = std::complex<float>;

/// The smallest product of 2, 3, 5 and 7 that is at least `n`; transforms of such lengths are fast.
std::size_t good_fft_size(std::size_t n);

/// Memory aligned for transforms, zeroed at the start: the system does it page by page, in the
/// thread that comes to a page first.
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

/// Single-precision transforms in place, planned once and safe to run from several threads on
/// buffers of their own. Plans are estimated, never measured: the same bits in every run.
/// Nothing is normalised.
class Fft {
 public:
    enum class Direction { Forward, Inverse };

    /// `count` rows of `length` real numbers, each in `length + 2` floats, become rows of
    /// `length / 2 + 1` complex numbers; length even.
    static Fft real_to_complex(std::size_t length, std::size_t count);
    static Fft complex_to_real(std::size_t length, std::size_t count);

    /// `count` complex transforms: element i of transform j stands at i * stride + j * distance.
    struct Layout {
        std::size_t length, count, stride, distance;
    };
    static Fft complex_batch(const Layout& layout, Direction direction);

    void run(FftBuffer& buffer) const;

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
