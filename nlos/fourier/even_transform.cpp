// SPDX-License-Identifier: MIT
#include "nlos/fourier/even_transform.h"

#include <algorithm>

namespace nlos {

EvenTransform::EvenTransform(std::size_t nx, std::size_t ny)
    : nx_(nx),
      ny_(ny),
      rows_(Fft::complex_batch({period_y(), nx, 1, stride()}, Fft::Direction::Forward)),
      columns_(Fft::complex_batch({period_x(), ny, stride(), 1}, Fft::Direction::Forward)) {}

void EvenTransform::run(ComplexF* values, Workspace& work) const {
    const auto row = [&](std::size_t ix) { return work.complex() + ix * stride(); };
    for (std::size_t ix = 0; ix < nx_; ++ix) {
        const ComplexF* half = values + ix * ny_;
        std::copy_n(half, ny_, row(ix));
        std::reverse_copy(half + 1, half + ny_ - 1, row(ix) + ny_);
    }
    rows_.run(work);
    for (std::size_t ix = 1; ix + 1 < nx_; ++ix) {
        std::copy_n(row(ix), ny_, row(period_x() - ix));
    }
    columns_.run(work);
    for (std::size_t ix = 0; ix < nx_; ++ix) std::copy_n(row(ix), ny_, values + ix * ny_);
}

}  // namespace nlos
