// SPDX-License-Identifier: MIT
#pragma once

#include "nlos/fourier/fft.h"
#include "nlos/methods/methods.h"
#include "nlos/methods/slabs.h"
#include "nlos/preparation/conservative_resampling.h"

#include <cstdint>
#include <span>
#include <vector>

namespace nlos {

/// Lateral planes that a task transforms together.
inline constexpr std::size_t kSlabsPerBlock = 8;

/// Even bins of v = r^2 are 1 / (2 r) wide in r: as many as there are range bins would be coarser
/// than those in the near half of the volume and pull depths there towards the wall.
inline constexpr double kSquaredRangeBinsPerBin = 2.0;

/// The light cone: with v = (path length / 2)^2 and u = z^2, light from (x, y, u) reaches a wall
/// point (dx, dy) away at v = u + dx^2 + dy^2. Even bins of v, and the padded sizes of transforms;
/// they begin before what nobody observed.
struct Cone {
    std::vector<double> v_edges;  ///< squared range [m^2]
    std::size_t nx = 0, ny = 0;   ///< wall points
    std::size_t px = 0, py = 0;   ///< padded to at least twice
    std::size_t length = 0;       ///< padded number of v bins, see cone_period()
    bool is_same_for_all = true;  ///< device segments are the same for every pair
    double min_segment_m = 0.0;   ///< the shortest device segments

    std::size_t num_v() const { return v_edges.size() - 1; }
    double v_width() const { return v_edges[1] - v_edges[0]; }
    std::size_t num_frequencies() const { return length / 2 + 1; }
    std::size_t num_columns() const { return nx * ny; }
    /// From the spectrum at one frequency to that at the next.
    std::size_t plane_stride() const { return complex_row_stride(num_columns()); }
};

/// input          confocal scan with input.wall.grid
/// bins_per_bin   bins of v for every bin of range
/// throws         core::Error when the axis has no positive range
Cone make_cone(const MethodInput& input, double bins_per_bin);

/// The period of transforms along v, for a cone that lacks only that: an even number of bins, so
/// many that nothing that the farthest wall point sees behind the end of the axis comes back at its
/// start. Twice the axis is always enough; where the wall is small for the range, less is.
std::size_t cone_period(const Cone& cone, const WallGrid& grid);

/// The convolution's data g(v) of one wall point: bins of range [r_k, r_k+1] moved to bins of
/// v = r^2, each multiplied by r^power; dr/dv is in the bins' widths.
class ConeData {
 public:
    ConeData(const MethodInput& input, const Cone& cone, double power);

    /// Fills each of `rows` with num_v() values: the n-th with those of wall point
    /// (column / ny, column % ny), column = first_column + n.
    void fill(std::size_t first_column, std::span<float* const> rows) const;

    /// The bins of v of a wall point whose light was observed as a whole.
    core::BinRange observed(std::size_t column) const;

 private:
    std::size_t pair_of(std::size_t column) const;

    const MethodInput& input_;
    const Cone& cone_;
    double power_;
    ConservativeResampling common_;
};

/// f(u) -> rho(z): contents of the bins of u = z^2 moved to bins of z, per metre; this is
/// rho = 2 z f(z^2).
ConservativeResampling squared_range_to_depth(const MethodInput& input,
                                              const Cone& cone,
                                              BinSpread spread);

/// Where the cone meets one lateral offset: bin `shift` with weight `here`, the next one with
/// `next`; the two sum to 1 unless the offset is off the axis.
struct ConeEntry {
    std::uint32_t shift = 0;
    float here = 0.0F, next = 0.0F;
};

/// The light cone delta(v - dx^2 - dy^2), split linearly between two v bins so that each (dx, dy)
/// sums to 1. It is even in dx and dy: a quadrant says it all.
class ConeKernel {
 public:
    ConeKernel(const Cone& cone, const WallGrid& grid);

    std::size_t qx() const { return qx_; }
    std::size_t qy() const { return qy_; }
    double squared_norm() const { return squared_norm_; }
    ConeEntry entry(std::size_t ix, std::size_t iy) const {
        const std::size_t i = ix * qy_ + iy;
        return {shift_[i], here_[i], next_[i]};
    }

    /// Transforms of the quadrant along v, one frequency after the other: a phase is looked up, and
    /// its place in the table at the next frequency is a sum, where that of any would be a
    /// division.
    class Spectrum {
     public:
        /// kernel   must outlive the spectrum
        /// k        the first frequency
        Spectrum(const ConeKernel& kernel, std::size_t k);

        /// Writes the quadrant, [x][y], at a frequency and turns to the next.
        void next(ComplexF* quadrant);

     private:
        const ConeKernel& kernel_;
        std::size_t k_;
        std::vector<std::uint32_t> phase_indices_;  ///< of each entry's phase
    };

 private:
    std::size_t qx_, qy_;
    double squared_norm_ = 0.0;
    std::vector<std::uint32_t> shift_;  ///< of each entry, [x][y]
    std::vector<float> here_, next_;
    std::vector<ComplexF> phases_;  ///< of a whole period
};

/// Room for the spectrum of the largest of `num_slabs` slabs. One buffer serves all of them:
/// freeing and allocating again fragments the heap, which would take more memory than given.
FftBuffer make_slab_spectrum(const Cone& cone, std::size_t num_slabs);

/// g(v) of all wall points, transformed along v at a slab of its frequencies: stored [frequency of
/// the slab][x][y].
void fill_cone_spectrum(const MethodInput& input,
                        const Cone& cone,
                        double power,
                        const Slab& slab,
                        FftBuffer& spectrum,
                        const ProgressSpan& span);

/// Back from frequencies along v to voxels along z, negative values kept: adds the slab's
/// contribution to `values`, stored [x][y][z].
void add_spectrum_to_depth(const MethodInput& input,
                           const Cone& cone,
                           FftBuffer& spectrum,
                           const Slab& slab,
                           std::vector<float>& values,
                           const ProgressSpan& span);

/// Every wall point along squared range and its `components` back, every frequency there and its
/// components back laterally, and every frequency's kernel.
LeastWork least_cone_work(const MethodInput& input, std::size_t components);

}  // namespace nlos
