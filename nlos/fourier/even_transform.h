// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/fourier/fft.h"

namespace nlos {

/// Transform of an (nx, ny) array of complex numbers that is even around both its first and its
/// last element along either axis, so that it stands for a whole period of 2 (nx - 1) by
/// 2 (ny - 1) numbers, nx and ny at least 2. So is the result, which stands as [ky][kx], as spectra
/// of PaddedPlane do. Nothing is normalised.
///
/// Each of the two passes transforms whole periods, but only those that differ: FFTW's cosine
/// transforms, which need half the arithmetic, take several times as long.
class EvenTransform {
 public:
    EvenTransform(std::size_t nx, std::size_t ny);

    struct Workspace {
        FftBuffer rows, columns;
    };
    Workspace make_workspace() const;

    /// values   in: (nx, ny); out: the transform, (ny, nx)
    void run(ComplexF* values, Workspace& work) const;

 private:
    std::size_t period_x() const { return 2 * (nx_ - 1); }
    std::size_t period_y() const { return 2 * (ny_ - 1); }

    std::size_t nx_, ny_;
    Fft rows_, columns_;
};

}  // namespace nlos
