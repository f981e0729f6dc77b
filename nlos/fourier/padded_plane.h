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
///
/// Values stand as [x][y], spectra as [ky][kx]: a pass that reads columns and writes rows takes
/// half the time of one that writes columns.
class PaddedPlane {
 public:
    PaddedPlane(std::array<std::size_t, 2> size, std::array<std::size_t, 2> padded);

    struct Workspace {
        FftBuffer values, spectrum;
    };
    Workspace make_workspace() const;

    /// Row ix of the values: py of them along y.
    ComplexF* row(Workspace& work, std::size_t ix) const {
        return work.values.complex() + ix * complex_row_stride(padded_[1]);
    }
    /// Row iy of the spectrum: px of it along kx.
    ComplexF* spectrum_row(Workspace& work, std::size_t iy) const {
        return work.spectrum.complex() + iy * complex_row_stride(padded_[0]);
    }

    /// Copies values (nx, ny) into the workspace, padded by zeros.
    void load(const ComplexF* values, Workspace& work) const;
    /// Copies values (nx, ny) out of the workspace.
    void store(Workspace& work, ComplexF* values) const;

    /// Copy a spectrum (py, px) into and out of the workspace.
    void load_spectrum(const ComplexF* spectrum, Workspace& work) const;
    void store_spectrum(Workspace& work, ComplexF* spectrum) const;

    /// Adds the workspace's spectrum to `spectrum` (py, px).
    void add_spectrum(Workspace& work, ComplexF* spectrum) const;

    /// Values, of which rows from nx on count as 0, to their spectrum and back; neither keeps what
    /// it reads.
    void forward(Workspace& work) const;
    void inverse(Workspace& work) const;

    /// Multiplies the spectrum by a filter that is even along both axes, given by its quadrant
    /// (py / 2 + 1, px / 2 + 1).
    void multiply_by_quadrant(const ComplexF* quadrant, Workspace& work) const;

 private:
    std::array<std::size_t, 2> size_;
    std::array<std::size_t, 2> padded_;
    Fft rows_forward_, columns_forward_, columns_inverse_, rows_inverse_;
};

}  // namespace nlos
