// SPDX-License-Identifier: MIT
#include "nlos/fourier/padded_plane.h"

#include <algorithm>

namespace nlos {

using Direction = Fft::Direction;

PaddedPlane::PaddedPlane(std::array<std::size_t, 2> size, std::array<std::size_t, 2> padded)
    : size_(size),
      padded_(padded),
      rows_forward_(Fft::complex_batch({padded[1], size[0], 1, stride()}, Direction::Forward)),
      rows_inverse_(Fft::complex_batch({padded[1], size[0], 1, stride()}, Direction::Inverse)),
      columns_forward_(Fft::complex_batch({padded[0], padded[1], stride(), 1}, Direction::Forward)),
      columns_inverse_(
          Fft::complex_batch({padded[0], padded[1], stride(), 1}, Direction::Inverse)) {}

void PaddedPlane::load(const ComplexF* values, Workspace& work) const {
    std::fill_n(work.complex(), padded_[0] * stride(), ComplexF{});
    for (std::size_t ix = 0; ix < size_[0]; ++ix) {
        std::copy_n(values + ix * size_[1], size_[1], row(work, ix));
    }
}

void PaddedPlane::store(Workspace& work, ComplexF* values) const {
    for (std::size_t ix = 0; ix < size_[0]; ++ix) {
        std::copy_n(row(work, ix), size_[1], values + ix * size_[1]);
    }
}

void PaddedPlane::load_spectrum(const ComplexF* spectrum, Workspace& work) const {
    for (std::size_t ix = 0; ix < padded_[0]; ++ix) {
        std::copy_n(spectrum + ix * padded_[1], padded_[1], row(work, ix));
    }
}

void PaddedPlane::store_spectrum(Workspace& work, ComplexF* spectrum) const {
    for (std::size_t ix = 0; ix < padded_[0]; ++ix) {
        std::copy_n(row(work, ix), padded_[1], spectrum + ix * padded_[1]);
    }
}

void PaddedPlane::add_spectrum(Workspace& work, ComplexF* spectrum) const {
    for (std::size_t ix = 0; ix < padded_[0]; ++ix) {
        const ComplexF* values = row(work, ix);
        ComplexF* sum = spectrum + ix * padded_[1];
        for (std::size_t iy = 0; iy < padded_[1]; ++iy) sum[iy] += values[iy];
    }
}

void PaddedPlane::forward(Workspace& work) const {
    rows_forward_.run(work);
    columns_forward_.run(work);
}

void PaddedPlane::inverse(Workspace& work) const {
    columns_inverse_.run(work);
    rows_inverse_.run(work);
}

void PaddedPlane::multiply_by_quadrant(const ComplexF* quadrant, Workspace& work) const {
    const std::size_t qy = padded_[1] / 2 + 1;
    for (std::size_t ix = 0; ix < padded_[0]; ++ix) {
        const ComplexF* filter = quadrant + std::min(ix, padded_[0] - ix) * qy;
        ComplexF* values = row(work, ix);
        for (std::size_t iy = 0; iy < qy; ++iy) values[iy] = multiply(values[iy], filter[iy]);
        for (std::size_t iy = qy; iy < padded_[1]; ++iy) {
            values[iy] = multiply(values[iy], filter[padded_[1] - iy]);
        }
    }
}

}  // namespace nlos
