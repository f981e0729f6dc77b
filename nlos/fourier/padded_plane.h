// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/fourier/fft.h"

#include <array>
#include <cmath>
#include <cstddef>

namespace nlos {

// std::complex guards against infinities and overflow unless told otherwise; these have none.
inline ComplexF multiply(ComplexF a, ComplexF b) {
    return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}
inline float magnitude(ComplexF a) {
    return std::sqrt(a.real() * a.real() + a.imag() * a.imag());
}

/// Lateral transforms of complex values (nx, ny) padded by zeros to (px, py). Rows along y that
/// hold no data, or whose result nobody asks for, are not transformed. Nothing is normalised.
class PaddedPlane {
 public:
    PaddedPlane(std::array<std::size_t, 2> size, std::array<std::size_t, 2> padded);

    using Workspace = FftBuffer;
    Workspace make_workspace() const { return FftBuffer(2 * padded_[0] * stride()); }

    /// Row ix of a workspace: values along y.
    ComplexF* row(Workspace& work, std::size_t ix) const { return work.complex() + ix * stride(); }

    /// Copies values (nx, ny) into the workspace, padded by zeros.
    void load(const ComplexF* values, Workspace& work) const;
    /// Copies values (nx, ny) out of the workspace.
    void store(Workspace& work, ComplexF* values) const;

    /// Copy a spectrum (px, py) into and out of the workspace.
    void load_spectrum(const ComplexF* spectrum, Workspace& work) const;
    void store_spectrum(Workspace& work, ComplexF* spectrum) const;

    /// Adds the workspace's spectrum to `spectrum` (px, py).
    void add_spectrum(Workspace& work, ComplexF* spectrum) const;

    void forward(Workspace& work) const;
    /// Only the first nx rows are right afterwards.
    void inverse(Workspace& work) const;

    /// Multiplies the spectrum by a filter that is even along both axes, given by its quadrant
    /// (px / 2 + 1, py / 2 + 1).
    void multiply_by_quadrant(const ComplexF* quadrant, Workspace& work) const;

 private:
    /// Distance of rows: not a power of two, which would crowd a column into few cache sets.
    std::size_t stride() const { return padded_[1] + 8; }

    std::array<std::size_t, 2> size_;
    std::array<std::size_t, 2> padded_;
    Fft rows_forward_, rows_inverse_, columns_forward_, columns_inverse_;
};

}  // namespace nlos
