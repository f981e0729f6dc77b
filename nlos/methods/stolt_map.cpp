// SPDX-License-Identifier: MIT
#include "nlos/methods/stolt_map.h"

#include "nlos/fourier/padded_plane.h"
#include "nlos/fourier/unit_phasor.h"

#include <cmath>

namespace nlos {

StoltMap::StoltMap(const WallGrid& wall, const FkGrids& grids)
    : wall_(wall),
      grids_(grids),
      inverse_(Fft::complex_batch(
          grids.depth_length, 1, {1, grids.depth_length}, Fft::Direction::Inverse)),
      num_kz_((grids.depth_length - 1) / 2) {}

void StoltMap::apply(const RowSlab& slab, std::size_t pair, ComplexF* field) const {
    const std::size_t first = slab.begin[pair];
    const std::size_t num_rows = slab.begin[pair + 1] - first;
    const std::size_t num_f = grids_.num_frequencies();
    const std::size_t num_depths = grids_.num_depths();
    std::vector<ComplexF> spectra(num_rows * grids_.px * (num_f + 1));
    for (std::size_t r = 0; r < num_rows; ++r) {
        gather(field, slab, first + r, spectra.data() + r * grids_.px * (num_f + 1));
    }
    std::vector<ComplexF> depths(num_rows * grids_.px * num_depths);
    FftBuffer column(2 * grids_.depth_length);
    Readings readings(num_kz_);
    for (std::size_t ix = 0; ix <= grids_.px / 2; ++ix) {
        fill_readings(ix, slab.ky[first], readings);
        for (std::size_t r = 0; r < num_rows; ++r) {
            for (const std::size_t x : {ix, (grids_.px - ix) % grids_.px}) {
                const std::size_t i = r * grids_.px + x;
                read_column(readings, spectra.data() + i * (num_f + 1), column);
                std::copy_n(column.complex(), num_depths, depths.data() + i * num_depths);
                if (2 * ix % grids_.px == 0) break;  // its own mirror image
            }
        }
    }
    for (std::size_t r = 0; r < num_rows; ++r) {
        scatter(depths.data() + r * grids_.px * num_depths, slab, first + r, field);
    }
}

void StoltMap::fill_readings(std::size_t ix, std::size_t iy, Readings& r) const {
    const double kx = static_cast<double>(ix) / (static_cast<double>(grids_.px) * wall_.pitch_m[0]);
    const double ky = static_cast<double>(iy) / (static_cast<double>(grids_.py) * wall_.pitch_m[1]);
    const double lateral = kx * kx + ky * ky;
    const double kz_step = 1.0 / (static_cast<double>(grids_.depth_length) * grids_.step_m);
    const double period = grids_.period_m();
    const auto highest = static_cast<double>(grids_.num_frequencies() - 1) / period;
    const double kz_end = std::sqrt(std::max(0.0, highest * highest - lateral)) / kz_step;
    r.count = std::min(num_kz_, static_cast<std::size_t>(kz_end));
    for (std::size_t i = 0; i < r.count; ++i) {
        const double kz = static_cast<double>(i + 1) * kz_step;
        const double f = std::sqrt(lateral + kz * kz);
        const double position = f * period;
        const int below = static_cast<int>(position);
        const UnitPhasor phase = unit_phasor(kz * grids_.first_z_m - f * grids_.center_m);
        const auto jacobian = static_cast<float>(kz / f);
        r.below[i] = below;
        r.late[i] = static_cast<float>(position - below);
        r.re[i] = jacobian * phase.re;
        r.im[i] = jacobian * phase.im;
    }
}

void StoltMap::read_column(const Readings& r, const ComplexF* spectrum, FftBuffer& column) const {
    ComplexF* out = column.complex();
    out[0] = {};
    for (std::size_t i = 0; i < r.count; ++i) {
        const ComplexF* below = spectrum + r.below[i];
        const ComplexF value = below[0] + r.late[i] * (below[1] - below[0]);
        out[i + 1] = multiply(value, {r.re[i], r.im[i]});
    }
    std::fill(out + r.count + 1, out + grids_.depth_length, ComplexF{});
    inverse_.run(column);
}

/// [f][kx] of one row -> [kx][f], with one element to spare behind each column.
void StoltMap::gather(const ComplexF* field,
                      const RowSlab& slab,
                      std::size_t row,
                      ComplexF* columns) const {
    const std::size_t num_f = grids_.num_frequencies();
    for (std::size_t f = 0; f < num_f; ++f) {
        const ComplexF* in = field + slab.offset(f, row);
        for (std::size_t x = 0; x < grids_.px; ++x) columns[x * (num_f + 1) + f] = in[x];
    }
}

/// [kx][z] -> [z][kx] of one row.
void StoltMap::scatter(const ComplexF* columns,
                       const RowSlab& slab,
                       std::size_t row,
                       ComplexF* field) const {
    const std::size_t num_depths = grids_.num_depths();
    for (std::size_t z = 0; z < num_depths; ++z) {
        ComplexF* out = field + slab.offset(z, row);
        for (std::size_t x = 0; x < grids_.px; ++x) out[x] = columns[x * num_depths + z];
    }
}

}  // namespace nlos
