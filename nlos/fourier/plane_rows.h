// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/fourier/fft.h"

#include <cstddef>

namespace nlos {

/// A few neighbouring columns of a stack of planes, each a row of its own: element k of row i is
/// column i of plane k. Planes are far apart in memory, where the next ones are asked for ahead.
struct PlaneRows {
    ComplexF* rows;
    std::size_t row_stride, num_rows;
    ComplexF* planes;  ///< from the first of these columns on
    std::size_t plane_stride, num_planes;

    void copy_to_planes() const;
    void copy_to_rows() const;
};

}  // namespace nlos
