// SPDX-License-Identifier: MIT
#include "nlos/fourier/even_transform.h"

#include <algorithm>

namespace nlos {

EvenTransform::EvenTransform(std::size_t nx, std::size_t ny)
    : nx_(nx),
      ny_(ny),
      rows_(Fft::complex_batch(
          period_y(), in_fours(nx), {1, complex_row_stride(period_y())}, Fft::Direction::Forward)),
      columns_(Fft::complex_batch(period_x(),
                                  in_fours(ny),
                                  {complex_row_stride(period_y()), 1},
                                  {1, complex_row_stride(period_x())},
                                  Fft::Direction::Forward)) {}

EvenTransform::Workspace EvenTransform::make_workspace() const {
    const std::size_t num_rows = std::max(period_x(), in_fours(nx_));
    return {FftBuffer(2 * num_rows * complex_row_stride(period_y())),
            FftBuffer(2 * in_fours(ny_) * complex_row_stride(period_x()))};
}

void EvenTransform::run(ComplexF* values, Workspace& work) const {
    const auto row = [&](std::size_t ix) {
        return work.rows.complex() + ix * complex_row_stride(period_y());
    };
    for (std::size_t ix = 0; ix < nx_; ++ix) {
        const ComplexF* half = values + ix * ny_;
        std::copy_n(half, ny_, row(ix));
        std::reverse_copy(half + 1, half + ny_ - 1, row(ix) + ny_);
    }
    rows_.run(work.rows);
    for (std::size_t ix = 1; ix + 1 < nx_; ++ix) {
        std::copy_n(row(ix), ny_, row(period_x() - ix));
    }
    columns_.run(work.rows, work.columns);
    for (std::size_t iy = 0; iy < ny_; ++iy) {
        std::copy_n(
            work.columns.complex() + iy * complex_row_stride(period_x()), nx_, values + iy * nx_);
    }
}

}  // namespace nlos
