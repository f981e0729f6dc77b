// SPDX-License-Identifier: MIT
#include "nlos/fk_migration.h"

#include "nlos/fft.h"
#include "nlos/padded_plane.h"
#include "nlos/unit_phasor.h"

#include <cmath>
#include <vector>

// Frequencies f are cycles per metre of range r = path length / 2. The data's phase is taken
// relative to the middle of the range covered: the spectrum is then smooth enough to be read
// between its samples by linear interpolation, whose known damping towards both ends of the range
// (a squared sinc) is taken off beforehand.

namespace nlos {
namespace {

constexpr std::size_t kColumnsPerBlock = 16;
constexpr std::size_t kSlabsPerBlock = 8;

double squared_sinc(double x) {
    const double angle = core::kPi * x;
    return std::abs(angle) < 1e-9 ? 1.0 : std::pow(std::sin(angle) / angle, 2);
}

/// Sizes and positions of data, spectrum and volume.
struct Grids {
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
    std::size_t num_slabs() const { return std::max(num_frequencies(), num_z * samples); }
    double period_m() const { return static_cast<double>(length) * bin_m; }
};

Grids make_grids(const MethodInput& input) {
    const core::TimeAxis& axis = input.time_axis;
    const auto [shortest, longest] = core::device_leg_range_m(input.scan);
    const double begin = std::max(0.0, 0.5 * (axis.opl_start_m - longest));
    const double end = std::max(begin + axis.bin_width_m, 0.5 * (axis.opl_end_m() - shortest));
    Grids grids;
    grids.nx = input.wall.grid->size[0];
    grids.ny = input.wall.grid->size[1];
    grids.px = 2 * good_fft_size(grids.nx);
    grids.py = 2 * good_fft_size(grids.ny);
    grids.bin_m = 0.5 * axis.bin_width_m;
    grids.center_m = 0.5 * (begin + end);
    const auto covered = static_cast<std::size_t>(std::ceil((end - begin) / grids.bin_m - 1e-6));
    grids.length = 2 * good_fft_size(std::max(covered, static_cast<std::size_t>(axis.num_bins)));
    grids.num_z = input.axes.z_m.size();
    const double voxel_m =
        (input.z_range_m[1] - input.z_range_m[0]) / static_cast<double>(grids.num_z);
    grids.samples = static_cast<std::size_t>(std::ceil(voxel_m / grids.bin_m - 1e-6));
    grids.step_m = voxel_m / static_cast<double>(grids.samples);
    grids.first_z_m = input.z_range_m[0] + 0.5 * grids.step_m;
    // Depths outside the volume must not be folded into it.
    const double period = std::max(grids.period_m(), end + input.z_range_m[1] - input.z_range_m[0]);
    grids.depth_length =
        good_fft_size(std::max(static_cast<std::size_t>(std::ceil(period / grids.step_m - 1e-6)),
                               grids.num_z * grids.samples));
    return grids;
}

/// Amplitude of the virtual wave at each wall point, transformed along range with its phase
/// relative to the centre; `out` is stored [frequency][x][y].
class RangeTransform {
 public:
    RangeTransform(const MethodInput& input, const Grids& grids, Falloff falloff)
        : input_(input),
          grids_(grids),
          falloff_(falloff),
          forward_(Fft::real_to_complex(grids.length, kColumnsPerBlock)) {}

    void fill(std::size_t begin, std::size_t end, ComplexF* out) const {
        const std::size_t row_floats = grids_.length + 2;
        const std::size_t num_columns = grids_.nx * grids_.ny;
        FftBuffer rows(kColumnsPerBlock * row_floats);
        for (std::size_t column = begin; column < end; ++column) {
            fill_amplitudes(column, rows.data() + (column - begin) * row_floats);
        }
        forward_.run(rows);
        std::vector<double> first_range_m;
        for (std::size_t column = begin; column < end; ++column) {
            first_range_m.push_back(range_m(pair_of(column), 0));
        }
        for (std::size_t f = 0; f < grids_.num_frequencies(); ++f) {
            const double frequency = static_cast<double>(f) / grids_.period_m();
            for (std::size_t i = 0; i < end - begin; ++i) {
                const UnitPhasor phase =
                    unit_phasor(-frequency * (first_range_m[i] - grids_.center_m));
                out[f * num_columns + begin + i] =
                    multiply(rows.complex()[i * (row_floats / 2) + f], {phase.re, phase.im});
            }
        }
    }

 private:
    std::size_t pair_of(std::size_t column) const {
        return input_.wall.grid->point(column / grids_.ny, column % grids_.ny);
    }
    double range_m(std::size_t pair, std::size_t bin) const {
        return 0.5 * (input_.time_axis.bin_center_m(static_cast<double>(bin)) -
                      input_.scan.device_legs_m(pair));
    }

    void fill_amplitudes(std::size_t column, float* amplitudes) const {
        const std::size_t pair = pair_of(column);
        const auto histogram = input_.transient.histogram(pair);
        const double first = range_m(pair, 0);
        for (std::size_t bin = 0; bin < histogram.size(); ++bin) {
            const double range = first + static_cast<double>(bin) * grids_.bin_m;
            const double power = falloff_ == Falloff::Diffuse ? range : 1.0;
            const double damping = squared_sinc((range - grids_.center_m) / grids_.period_m());
            const double amplitude =
                range > 0.0 && histogram[bin] > 0.0F
                    ? power * std::sqrt(static_cast<double>(histogram[bin])) / damping
                    : 0.0;
            amplitudes[bin] = static_cast<float>(amplitude);
        }
    }

    const MethodInput& input_;
    const Grids& grids_;
    Falloff falloff_;
    Fft forward_;
};

/// Reads the spectrum at the f that belongs to each kz and transforms along kz: one row of (kx, ky)
/// and its mirror image at a time, as they share all weights.
class StoltMap {
 public:
    StoltMap(const WallGrid& wall, const Grids& grids)
        : wall_(wall),
          grids_(grids),
          inverse_(Fft::complex_batch({grids.depth_length, 1, 1, grids.depth_length},
                                      Fft::Direction::Inverse)),
          num_kz_((grids.depth_length - 1) / 2) {}

    /// Maps the rows at kx index `ix` and px - ix of `field` [f][kx][ky] into [z][kx][ky].
    void apply(std::size_t ix, ComplexF* field) const {
        const std::size_t mirror = (grids_.px - ix) % grids_.px;
        std::vector<std::size_t> rows{ix};
        if (mirror != ix) rows.push_back(mirror);
        const std::size_t num_f = grids_.num_frequencies();
        const std::size_t num_depths = grids_.num_z * grids_.samples;
        std::vector<ComplexF> spectra(rows.size() * grids_.py * (num_f + 1));
        gather(field, rows, num_f, spectra);
        std::vector<ComplexF> depths(rows.size() * grids_.py * num_depths);
        FftBuffer column(2 * grids_.depth_length);
        Readings readings(num_kz_);
        for (std::size_t iy = 0; iy <= grids_.py / 2; ++iy) {
            fill_readings(ix, iy, readings);
            for (std::size_t r = 0; r < rows.size(); ++r) {
                for (const std::size_t y : {iy, (grids_.py - iy) % grids_.py}) {
                    const std::size_t i = r * grids_.py + y;
                    read_column(readings, spectra.data() + i * (num_f + 1), column);
                    std::copy_n(column.complex(), num_depths, depths.data() + i * num_depths);
                    if (2 * iy % grids_.py == 0) break;  // its own mirror image
                }
            }
        }
        scatter(depths, rows, num_depths, field);
    }

 private:
    /// Where in the spectrum each kz reads, and the factor of what is read there.
    struct Readings {
        explicit Readings(std::size_t n) : below(n), late(n), re(n), im(n) {}
        std::size_t count = 0;  ///< larger kz lie beyond the highest frequency
        std::vector<int> below;
        std::vector<float> late, re, im;
    };

    void fill_readings(std::size_t ix, std::size_t iy, Readings& r) const {
        const double kx =
            static_cast<double>(ix) / (static_cast<double>(grids_.px) * wall_.pitch_m[0]);
        const double ky =
            static_cast<double>(iy) / (static_cast<double>(grids_.py) * wall_.pitch_m[1]);
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

    void read_column(const Readings& r, const ComplexF* spectrum, FftBuffer& column) const {
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

    /// [slab][x][y] -> [row][y][slab], with one element to spare behind each column.
    void gather(const ComplexF* field,
                const std::vector<std::size_t>& rows,
                std::size_t num_slabs,
                std::vector<ComplexF>& columns) const {
        for (std::size_t slab = 0; slab < num_slabs; ++slab) {
            for (std::size_t r = 0; r < rows.size(); ++r) {
                const ComplexF* in = field + (slab * grids_.px + rows[r]) * grids_.py;
                ComplexF* out = columns.data() + r * grids_.py * (num_slabs + 1) + slab;
                for (std::size_t y = 0; y < grids_.py; ++y) out[y * (num_slabs + 1)] = in[y];
            }
        }
    }

    void scatter(const std::vector<ComplexF>& columns,
                 const std::vector<std::size_t>& rows,
                 std::size_t num_slabs,
                 ComplexF* field) const {
        for (std::size_t slab = 0; slab < num_slabs; ++slab) {
            for (std::size_t r = 0; r < rows.size(); ++r) {
                const ComplexF* in = columns.data() + r * grids_.py * num_slabs + slab;
                ComplexF* out = field + (slab * grids_.px + rows[r]) * grids_.py;
                for (std::size_t y = 0; y < grids_.py; ++y) out[y] = in[y * num_slabs];
            }
        }
    }

    const WallGrid& wall_;
    const Grids& grids_;
    Fft inverse_;
    std::size_t num_kz_;
};

/// Squared magnitudes of voxels [begin, end) along z: transforms their depth samples back to (x, y)
/// and averages the samples of each voxel.
void fill_voxels(const Grids& grids,
                 const PaddedPlane& plane,
                 const ComplexF* field,
                 std::size_t begin,
                 std::size_t end,
                 Volume& volume) {
    PaddedPlane::Workspace work = plane.make_workspace();
    const std::size_t count = end - begin;
    const float share = 1.0F / static_cast<float>(grids.samples);
    std::vector<float> sums(grids.nx * grids.ny * count, 0.0F);
    for (std::size_t iz = begin; iz < end; ++iz) {
        for (std::size_t i = 0; i < grids.samples; ++i) {
            plane.load_spectrum(field + (iz * grids.samples + i) * grids.px * grids.py, work);
            plane.inverse(work);
            for (std::size_t ix = 0; ix < grids.nx; ++ix) {
                const ComplexF* row = plane.row(work, ix);
                for (std::size_t iy = 0; iy < grids.ny; ++iy) {
                    sums[(ix * grids.ny + iy) * count + iz - begin] +=
                        share * (row[iy].real() * row[iy].real() + row[iy].imag() * row[iy].imag());
                }
            }
        }
    }
    for (std::size_t column = 0; column < grids.nx * grids.ny; ++column) {
        std::copy_n(sums.data() + column * count,
                    count,
                    volume.values.data() + column * grids.num_z + begin);
    }
}

}  // namespace

Volume fk_migration(const MethodInput& input, Falloff falloff) {
    const Grids grids = make_grids(input);
    const std::size_t num_columns = grids.nx * grids.ny;
    const std::size_t slab_size = grids.px * grids.py;

    FftBuffer spectrum(2 * grids.num_frequencies() * num_columns);
    const RangeTransform transform(input, grids, falloff);
    parallel_blocks_with_progress(num_columns,
                                  kColumnsPerBlock,
                                  {input.progress, 0.0, 0.1, "range to frequency"},
                                  [&](std::size_t begin, std::size_t end) {
                                      transform.fill(begin, end, spectrum.complex());
                                  });

    FftBuffer field(2 * grids.num_slabs() * slab_size);
    const PaddedPlane plane({grids.nx, grids.ny}, {grids.px, grids.py});
    parallel_blocks_with_progress(grids.num_frequencies(),
                                  kSlabsPerBlock,
                                  {input.progress, 0.1, 0.4, "lateral transform"},
                                  [&](std::size_t begin, std::size_t end) {
                                      PaddedPlane::Workspace work = plane.make_workspace();
                                      for (std::size_t f = begin; f < end; ++f) {
                                          plane.load(spectrum.complex() + f * num_columns, work);
                                          plane.forward(work);
                                          plane.store_spectrum(work,
                                                               field.complex() + f * slab_size);
                                      }
                                  });
    spectrum = FftBuffer(0);

    const StoltMap map(*input.wall.grid, grids);
    parallel_blocks_with_progress(
        grids.px / 2 + 1,
        1,
        {input.progress, 0.4, 0.7, "migration"},
        [&](std::size_t begin, std::size_t) { map.apply(begin, field.complex()); });

    Volume volume{input.axes, std::vector<float>(num_columns * grids.num_z), {}};
    parallel_blocks_with_progress(grids.num_z,
                                  kSlabsPerBlock,
                                  {input.progress, 0.7, 1.0, "lateral transform"},
                                  [&](std::size_t begin, std::size_t end) {
                                      fill_voxels(
                                          grids, plane, field.complex(), begin, end, volume);
                                  });
    return volume;
}

double fk_migration_bytes(const MethodInput& input) {
    const Grids grids = make_grids(input);
    const auto columns = static_cast<double>(grids.nx * grids.ny);
    const auto plane = static_cast<double>(grids.px * (grids.py + 8));
    const double field = 8.0 * plane * static_cast<double>(grids.num_slabs());
    const double spectrum = 8.0 * columns * static_cast<double>(grids.num_frequencies());
    const double volume = 4.0 * columns * static_cast<double>(grids.num_z);
    const double rows = 2.0 * static_cast<double>(grids.py * 2 * grids.num_slabs());
    const double per_thread = 8.0 * (plane + rows) + 4.0 * columns * kSlabsPerBlock;
    return field + std::max(spectrum, volume) + per_thread * core::thread_count();
}

}  // namespace nlos
