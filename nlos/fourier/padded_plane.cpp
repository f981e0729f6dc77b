// SPDX-License-Identifier: MIT
#include "nlos/fourier/padded_plane.h"

#include <algorithm>

namespace nlos {

using Direction = Fft::Direction;

PaddedPlane::PaddedPlane(std::array<std::size_t, 2> size, std::array<std::size_t, 2> padded)
    : size_(size),
      padded_(padded),
      rows_forward_(Fft::complex_batch(
          padded[1], in_fours(size[0]), {1, complex_row_stride(padded[1])}, Direction::Forward)),
      columns_forward_(Fft::complex_batch(padded[0],
                                          in_fours(padded[1]),
                                          {complex_row_stride(padded[1]), 1},
                                          {1, complex_row_stride(padded[0])},
                                          Direction::Forward)),
      columns_inverse_(Fft::complex_batch(
          padded[0], in_fours(padded[1]), {1, complex_row_stride(padded[0])}, Direction::Inverse)),
      rows_inverse_(Fft::complex_batch(padded[1],
                                       in_fours(size[0]),
                                       {complex_row_stride(padded[0]), 1},
                                       {1, complex_row_stride(padded[1])},
                                       Direction::Inverse)) {}

PaddedPlane::Workspace PaddedPlane::make_workspace() const {
    return {FftBuffer(2 * in_fours(padded_[0]) * complex_row_stride(padded_[1])),
            FftBuffer(2 * in_fours(padded_[1]) * complex_row_stride(padded_[0]))};
}

void PaddedPlane::load(const ComplexF* values, Workspace& work) const {
    for (std::size_t ix = 0; ix < size_[0]; ++ix) {
        ComplexF* const padded = std::copy_n(values + ix * size_[1], size_[1], row(work, ix));
        std::fill_n(padded, padded_[1] - size_[1], ComplexF{});
    }
}

void PaddedPlane::store(Workspace& work, ComplexF* values) const {
    for (std::size_t ix = 0; ix < size_[0]; ++ix) {
        std::copy_n(row(work, ix), size_[1], values + ix * size_[1]);
    }
}

void PaddedPlane::load_spectrum(const ComplexF* spectrum, Workspace& work) const {
    for (std::size_t iy = 0; iy < padded_[1]; ++iy) {
        std::copy_n(spectrum + iy * padded_[0], padded_[0], spectrum_row(work, iy));
    }
}

void PaddedPlane::store_spectrum(Workspace& work, ComplexF* spectrum) const {
    for (std::size_t iy = 0; iy < padded_[1]; ++iy) {
        std::copy_n(spectrum_row(work, iy), padded_[0], spectrum + iy * padded_[0]);
    }
}

void PaddedPlane::add_spectrum(Workspace& work, ComplexF* spectrum) const {
    for (std::size_t iy = 0; iy < padded_[1]; ++iy) {
        const ComplexF* values = spectrum_row(work, iy);
        ComplexF* sum = spectrum + iy * padded_[0];
        for (std::size_t ix = 0; ix < padded_[0]; ++ix) sum[ix] += values[ix];
    }
}

void PaddedPlane::forward(Workspace& work) const {
    std::fill(row(work, size_[0]), row(work, in_fours(size_[0])), ComplexF{});
    rows_forward_.run(work.values);
    columns_forward_.run(work.values, work.spectrum);
}

void PaddedPlane::inverse(Workspace& work) const {
    columns_inverse_.run(work.spectrum);
    rows_inverse_.run(work.spectrum, work.values);
}

void PaddedPlane::multiply_by_quadrant(const ComplexF* quadrant, Workspace& work) const {
    const std::size_t qx = padded_[0] / 2 + 1;
    for (std::size_t iy = 0; iy < padded_[1]; ++iy) {
        const ComplexF* filter = quadrant + std::min(iy, padded_[1] - iy) * qx;
        ComplexF* values = spectrum_row(work, iy);
        for (std::size_t ix = 0; ix < qx; ++ix) values[ix] = multiply(values[ix], filter[ix]);
        for (std::size_t ix = qx; ix < padded_[0]; ++ix) {
            values[ix] = multiply(values[ix], filter[padded_[0] - ix]);
        }
    }
}

}  // namespace nlos
