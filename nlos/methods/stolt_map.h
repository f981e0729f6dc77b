// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/fourier/fft.h"
#include "nlos/preparation/wall_frame.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace nlos {

/// Sizes and positions of data, spectrum and volume.
struct FkGrids {
    std::size_t nx = 0, ny = 0;    ///< wall points
    std::size_t px = 0, py = 0;    ///< padded to at least twice
    std::size_t length = 0;        ///< padded number of range bins
    double bin_m = 0.0;            ///< of range
    double center_m = 0.0;         ///< middle of the range covered
    std::size_t num_z = 0;         ///< voxels along z
    std::size_t samples = 1;       ///< of depth per voxel: no bin falls between them
    double step_m = 0.0;           ///< of depth samples
    double first_z_m = 0.0;        ///< of depth samples
    std::size_t depth_length = 0;  ///< period in depth samples

    std::size_t num_frequencies() const { return length / 2 + 1; }
    std::size_t num_depths() const { return num_z * samples; }
    std::size_t num_planes() const { return std::max(num_frequencies(), num_depths()); }
    std::size_t num_columns() const { return nx * ny; }
    /// From the columns at one frequency to those at the next.
    std::size_t plane_stride() const { return complex_row_stride(num_columns()); }
    double period_m() const { return static_cast<double>(length) * bin_m; }
};

/// Rows of the lateral spectrum that are held at a time: those of some |ky|, each ky followed by
/// its mirror image.
struct RowSlab {
    std::vector<std::size_t> ky;     ///< index of each row held
    std::vector<std::size_t> begin;  ///< first row of each |ky|, and one past the last row
    std::size_t px = 0;

    std::size_t num_pairs() const { return begin.size() - 1; }
    /// Where row `row` of a plane begins.
    std::size_t offset(std::size_t plane, std::size_t row) const {
        return plane * complex_row_stride(ky.size() * px) + row * px;
    }
};

/// Reads the spectrum at the f that belongs to each kz and transforms along kz: one row of (ky, kx)
/// and its mirror image at a time, as they share all weights. Source: [Lindell2019].
class StoltMap {
 public:
    StoltMap(const WallGrid& wall, const FkGrids& grids);

    /// Maps the rows of the slab's pair `pair` of `field` [f][row][kx] into [z][row][kx].
    void apply(const RowSlab& slab, std::size_t pair, ComplexF* field) const;

 private:
    /// Where in the spectrum each kz reads, and the factor of what is read there.
    struct Readings {
        explicit Readings(std::size_t n) : below(n), late(n), re(n), im(n) {}
        std::size_t count = 0;  ///< larger kz lie beyond the highest frequency
        std::vector<int> below;
        std::vector<float> late, re, im;
    };

    void fill_readings(std::size_t ix, std::size_t iy, Readings& r) const;
    void read_column(const Readings& r, const ComplexF* spectrum, FftBuffer& column) const;
    void gather(const ComplexF* field,
                const RowSlab& slab,
                std::size_t row,
                ComplexF* columns) const;
    void scatter(const ComplexF* columns,
                 const RowSlab& slab,
                 std::size_t row,
                 ComplexF* field) const;

    const WallGrid& wall_;
    const FkGrids& grids_;
    Fft inverse_;
    std::size_t num_kz_;
};

}  // namespace nlos
