// SPDX-License-Identifier: MIT
// f-k migration: a confocal scan of a plane is the wave field, at the plane, of a wave that starts
// everywhere on the hidden surface at once and travels with one metre of range per metre. Its
// spectrum is moved from (kx, ky, f) to (kx, ky, kz) with f^2 = kx^2 + ky^2 + kz^2, which gives
// the field at the start.
//
// That wave, of amplitude f at the start, is d/dr (r M) at range r, M being the mean of f over the
// sphere of that radius. What is measured is the sum of f / r^4 over the sphere on diffuse
// surfaces and of f / r^2 on retroreflecting ones: times r^3 or r, and derived along range, it is
// the wave. [Lindell2019] takes the root of what is measured for it. But light of several surfaces
// adds up, its root does not, so that they blur each other's depths; and without the derivative a
// haze of low frequencies lies about them.
//
// Settings: falloff. Slabs of |kx|; each repeats the lateral transforms. The volume is the field up
// to a common factor, 0 where it is negative. Its magnitude, often shown instead, is an envelope
// along z: wider, and its peaks lie farther from the surface.
#include "nlos/fourier/fft.h"
#include "nlos/fourier/padded_plane.h"
#include "nlos/fourier/plane_rows.h"
#include "nlos/fourier/unit_phasor.h"
#include "nlos/methods/methods.h"
#include "nlos/methods/slabs.h"
#include "nlos/methods/stolt_map.h"

#include <algorithm>
#include <cmath>
#include <vector>

// Frequencies f are cycles per metre of range r = path length / 2. The data's phase is taken
// relative to the middle of the range covered: the spectrum is then smooth enough to be read
// between its samples by linear interpolation, whose known damping towards both ends of the range
// (a squared sinc) is taken off beforehand.

namespace nlos {
namespace {

constexpr std::size_t kColumnsPerBatch = 16;
constexpr std::size_t kPlanesPerBlock = 8;

double squared_sinc(double x) {
    const double angle = core::kPi * x;
    return std::abs(angle) < 1e-9 ? 1.0 : std::pow(std::sin(angle) / angle, 2);
}

/// The derivative along range of a frequency in fractions of the bins' highest, but for the factor
/// i. Near that one bins alias and counts are noise: a window closes there.
double windowed_derivative(double frequency) {
    constexpr double kWindowPower = 6.0;
    return frequency * std::pow(std::cos(0.5 * core::kPi * frequency), kWindowPower);
}

FkGrids make_grids(const MethodInput& input) {
    const core::TimeAxis& axis = input.time_axis;
    const auto [shortest, longest] = core::device_segment_range_m(input.scan);
    const double begin = std::max(0.0, 0.5 * (axis.opl_start_m - longest));
    const double end = std::max(begin + axis.bin_width_m, 0.5 * (axis.opl_end_m() - shortest));
    FkGrids grids;
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

/// The wave at each wall point, transformed along range with its phase relative to the centre.
/// `out` is stored [frequency][x][y].
class RangeTransform {
 public:
    RangeTransform(const MethodInput& input, const FkGrids& grids, Falloff falloff)
        : input_(input),
          grids_(grids),
          falloff_(falloff),
          forward_(Fft::real_to_complex(grids.length, kColumnsPerBatch)) {
        for (std::size_t f = 0; f < grids.num_frequencies(); ++f) {
            const double fraction =
                2.0 * static_cast<double>(f) / static_cast<double>(grids.length);
            derivative_.push_back(static_cast<float>(windowed_derivative(fraction)));
        }
    }

    void fill(std::size_t begin, std::size_t end, ComplexF* out) const {
        const std::size_t row_floats = Fft::row_floats(grids_.length);
        FftBuffer rows(kColumnsPerBatch * row_floats);
        FftBuffer spectra(rows.num_floats());
        std::vector<double> first_range_m;
        std::vector<double> bin_weights;
        for (std::size_t column = begin; column < end; ++column) {
            const std::size_t pair = pair_of(column);
            first_range_m.push_back(first_range(pair));
            if (column == begin || first_range_m.back() != first_range_m.end()[-2]) {
                bin_weights = weights(first_range_m.back());
            }
            const auto histogram = input_.transient.histogram(pair);
            std::transform(histogram.begin(),
                           histogram.end(),
                           bin_weights.begin(),
                           rows.data() + (column - begin) * row_floats,
                           [](float value, double weight) {
                               return static_cast<float>(weight * static_cast<double>(value));
                           });
        }
        forward_.run(rows, spectra);
        for (std::size_t i = 0; i < end - begin; ++i) {
            ComplexF* const row = spectra.complex() + i * (row_floats / 2);
            const double turns = (first_range_m[i] - grids_.center_m) / grids_.period_m();
            for (std::size_t f = 0; f < grids_.num_frequencies(); ++f) {
                const UnitPhasor phase = unit_phasor(-static_cast<double>(f) * turns);
                row[f] = multiply(row[f], {-derivative_[f] * phase.im, derivative_[f] * phase.re});
            }
        }
        const PlaneRows copies{spectra.complex(),
                               row_floats / 2,
                               end - begin,
                               out + begin,
                               grids_.plane_stride(),
                               grids_.num_frequencies()};
        copies.copy_to_planes();
    }

 private:
    std::size_t pair_of(std::size_t column) const {
        return input_.wall.grid->point(column / grids_.ny, column % grids_.ny);
    }
    /// The range of a pair's first bin [m].
    double first_range(std::size_t pair) const {
        return 0.5 * (input_.time_axis.bin_center_m(0.0) - input_.scan.device_segments_m(pair));
    }

    /// What bins are multiplied by whose first one lies at this range.
    std::vector<double> weights(double first_range_m) const {
        std::vector<double> weights;
        for (int bin = 0; bin < input_.time_axis.num_bins; ++bin) {
            const double range = first_range_m + bin * grids_.bin_m;
            const double weight = falloff_ == Falloff::Diffuse ? range * range * range : range;
            const double damping = squared_sinc((range - grids_.center_m) / grids_.period_m());
            weights.push_back(range > 0.0 ? weight / damping : 0.0);
        }
        return weights;
    }

    const MethodInput& input_;
    const FkGrids& grids_;
    Falloff falloff_;
    Fft forward_;
    std::vector<float> derivative_;  ///< of every frequency
};

/// How many |ky| a grid has.
std::size_t num_pairs(const FkGrids& grids) {
    return grids.py / 2 + 1;
}

/// Rows of some of the |ky|.
RowSlab rows_of(const FkGrids& grids, const Slab& pairs) {
    RowSlab slab;
    slab.px = grids.px;
    for (std::size_t iy = pairs.begin; iy < pairs.end; ++iy) {
        slab.begin.push_back(slab.ky.size());
        slab.ky.push_back(iy);
        const std::size_t mirror = (grids.py - iy) % grids.py;
        if (mirror != iy) slab.ky.push_back(mirror);
    }
    slab.begin.push_back(slab.ky.size());
    return slab;
}

/// Lateral transforms of the planes of a slab's field, those of frequencies and of depth samples.
class LateralTransform {
 public:
    using Workspace = PaddedPlane::Workspace;

    explicit LateralTransform(const FkGrids& grids)
        : grids_(grids), plane_({grids.nx, grids.ny}, {grids.px, grids.py}) {}

    Workspace make_workspace() const { return plane_.make_workspace(); }

    /// Transforms (x, y) of one frequency and keeps the slab's rows.
    void forward(const ComplexF* columns,
                 const RowSlab& slab,
                 std::size_t f,
                 Workspace& work,
                 ComplexF* field) const {
        plane_.load(columns, work);
        plane_.forward(work);
        for (std::size_t row = 0; row < slab.ky.size(); ++row) {
            std::copy_n(
                plane_.spectrum_row(work, slab.ky[row]), grids_.px, field + slab.offset(f, row));
        }
    }

    /// Adds the slab's contribution of depth sample `z` to `amplitudes` (x, y), the field's real
    /// part.
    void add_amplitudes(const ComplexF* field,
                        const RowSlab& slab,
                        std::size_t z,
                        Workspace& work,
                        float* amplitudes) const {
        if (slab.ky.size() < grids_.py) {
            std::fill_n(work.spectrum.data(), work.spectrum.num_floats(), 0.0F);
        }
        for (std::size_t row = 0; row < slab.ky.size(); ++row) {
            std::copy_n(
                field + slab.offset(z, row), grids_.px, plane_.spectrum_row(work, slab.ky[row]));
        }
        plane_.inverse(work);
        for (std::size_t ix = 0; ix < grids_.nx; ++ix) {
            const ComplexF* in = plane_.row(work, ix);
            float* out = amplitudes + ix * grids_.ny;
            for (std::size_t iy = 0; iy < grids_.ny; ++iy) out[iy] += in[iy].real();
        }
    }

 private:
    const FkGrids& grids_;
    PaddedPlane plane_;
};

/// Voxels [begin, end) along z, each an average over its depth samples; 0 where that is negative.
///
/// field    of the last slab
/// others   amplitudes of the slabs before it [z][x][y]; empty: there are none
void fill_voxels(const FkGrids& grids,
                 const LateralTransform& lateral,
                 const RowSlab& slab,
                 const ComplexF* field,
                 const std::vector<float>& others,
                 std::size_t begin,
                 std::size_t end,
                 Volume& volume) {
    LateralTransform::Workspace work = lateral.make_workspace();
    const std::size_t count = end - begin;
    const std::size_t num_columns = grids.num_columns();
    const float fraction = 1.0F / static_cast<float>(grids.samples);
    std::vector<float> sums(num_columns * count, 0.0F);
    std::vector<float> amplitudes(num_columns);
    for (std::size_t z = begin * grids.samples; z < end * grids.samples; ++z) {
        if (others.empty()) {
            std::fill(amplitudes.begin(), amplitudes.end(), 0.0F);
        } else {
            std::copy_n(others.data() + z * num_columns, num_columns, amplitudes.data());
        }
        lateral.add_amplitudes(field, slab, z, work, amplitudes.data());
        float* sum = sums.data() + z / grids.samples - begin;
        for (std::size_t column = 0; column < num_columns; ++column) {
            sum[column * count] += fraction * amplitudes[column];
        }
    }
    for (std::size_t column = 0; column < num_columns; ++column) {
        const float* sum = sums.data() + column * count;
        float* out = volume.values.data() + column * grids.num_z + begin;
        std::transform(sum, sum + count, out, [](float value) { return std::max(0.0F, value); });
    }
}

/// Field [z][row][kx] of one slab of rows.
///
/// spectrum   [f][x][y]
FftBuffer migrate(const MethodInput& input,
                  const FkGrids& grids,
                  const LateralTransform& lateral,
                  const RowSlab& slab,
                  FftBuffer& spectrum,
                  const core::Progress& progress) {
    FftBuffer field(2 * slab.offset(grids.num_planes(), 0));
    parallel_blocks_with_progress(
        grids.num_frequencies(),
        kPlanesPerBlock,
        {progress, 0.0, 0.3, "lateral transform"},
        [&](std::size_t begin, std::size_t end) {
            auto work = lateral.make_workspace();
            for (std::size_t f = begin; f < end; ++f) {
                lateral.forward(
                    spectrum.complex() + f * grids.plane_stride(), slab, f, work, field.complex());
            }
        });
    const StoltMap map(*input.wall.grid, grids);
    parallel_blocks_with_progress(
        slab.num_pairs(),
        1,
        {progress, 0.3, 0.7, "migration"},
        [&](std::size_t begin, std::size_t) { map.apply(slab, begin, field.complex()); });
    return field;
}

Volume fk_migration(const MethodInput& input,
                    const ReconstructSettings& settings,
                    std::size_t num_slabs) {
    const FkGrids grids = make_grids(input);
    const std::size_t num_columns = grids.num_columns();

    FftBuffer spectrum(2 * grids.num_frequencies() * grids.plane_stride());
    const RangeTransform transform(input, grids, settings.falloff);
    parallel_blocks_with_progress(num_columns,
                                  kColumnsPerBatch,
                                  {input.progress, 0.0, 0.1, "range to frequency"},
                                  [&](std::size_t begin, std::size_t end) {
                                      transform.fill(begin, end, spectrum.complex());
                                  });

    const LateralTransform lateral(grids);
    const core::Progress migration = input.progress.part(0.1, 1.0);
    std::vector<float> amplitudes;  // [z][x][y], of all slabs but the last
    Volume volume{input.axes, {}, {}};
    for (const Slab& pairs : split_into_slabs(num_pairs(grids), num_slabs)) {
        const core::Progress progress = pairs.part_of(migration, num_pairs(grids));
        const RowSlab slab = rows_of(grids, pairs);
        FftBuffer field = migrate(input, grids, lateral, slab, spectrum, progress);
        const ProgressSpan span{progress, 0.7, 1.0, "lateral transform"};
        if (pairs.end < num_pairs(grids)) {
            amplitudes.resize(num_columns * grids.num_depths());
            parallel_blocks_with_progress(
                grids.num_depths(),
                kPlanesPerBlock,
                span,
                [&](std::size_t begin, std::size_t last) {
                    auto work = lateral.make_workspace();
                    for (std::size_t z = begin; z < last; ++z) {
                        lateral.add_amplitudes(
                            field.complex(), slab, z, work, amplitudes.data() + z * num_columns);
                    }
                });
            continue;
        }
        spectrum = FftBuffer(0);
        volume.values.resize(num_columns * grids.num_z);
        parallel_blocks_with_progress(
            grids.num_z, kPlanesPerBlock, span, [&](std::size_t begin, std::size_t last) {
                fill_voxels(grids, lateral, slab, field.complex(), amplitudes, begin, last, volume);
            });
    }
    return volume;
}

double fk_migration_bytes(const MethodInput& input,
                          const ReconstructSettings& /*settings*/,
                          std::size_t num_slabs) {
    const FkGrids grids = make_grids(input);
    const auto columns = static_cast<double>(grids.num_columns());
    const auto plane = static_cast<double>(grids.px * complex_row_stride(grids.py));
    const std::size_t pairs = largest_slab(num_pairs(grids), num_slabs);
    const std::size_t rows = std::min(grids.py, 2 * pairs);
    const double field =
        8.0 * static_cast<double>(complex_row_stride(rows * grids.px) * grids.num_planes());
    const double spectrum =
        8.0 * static_cast<double>(grids.plane_stride() * grids.num_frequencies());
    const double amplitudes =
        num_slabs > 1 ? 4.0 * columns * static_cast<double>(grids.num_depths()) : 0.0;
    const double volume = 4.0 * columns * static_cast<double>(grids.num_z);
    const double lines = 2.0 * static_cast<double>(grids.px * 2 * grids.num_planes());
    const double per_thread =
        8.0 * (2.0 * plane + lines + columns) + 4.0 * columns * kPlanesPerBlock;
    return field + amplitudes + std::max(spectrum, volume) + per_thread * core::thread_count();
}

/// Every wall point along range, every frequency laterally, every lateral frequency along depth,
/// every depth back laterally.
LeastWork least_fk_work(const MethodInput& input, const ReconstructSettings& /*settings*/) {
    const FkGrids grids = make_grids(input);
    LeastWork work;
    work.row_length = grids.length;
    work.rows_forward = grids.num_columns();
    work.complex_rows = grids.px * grids.py;
    work.planes_forward = grids.num_frequencies();
    work.planes_inverse = grids.num_z;
    return work;
}

}  // namespace

const MethodTraits kFk{.method = Method::Fk,
                       .meaning = "f-k migration",
                       .captures = "confocal, planar grid; others by midpoints",
                       .run = fk_migration,
                       .bytes = fk_migration_bytes,
                       .errors = {{.model_fraction = 0.044,
                                   .noise_fraction = 0.345,
                                   .doubt = 8.0,
                                   .near_fraction = 0.27,
                                   .plateau = {0.0, 0.5, 8.0},
                                   .front = 0.4},
                                  {0.7, 0.3, 8.0}},
                       .needs = &kConfocalGrid,
                       .least_work = least_fk_work};

}  // namespace nlos
