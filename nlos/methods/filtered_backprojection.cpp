// SPDX-License-Identifier: MIT
// Filtered backprojection: sharpened by the negative Laplacian of a Gaussian of 1 voxel, cut to 5
// voxels along each axis [Velten2012], which is linear in the histograms, surfaces being positive
// with negative surroundings; or with filter=phasor of histograms convolved with a virtual wave.
#include "nlos/methods/backprojection.h"
#include "nlos/methods/virtual_wave.h"

#include <cmath>

namespace nlos {
namespace {

constexpr int kReach = 2;
constexpr int kTaps = 2 * kReach + 1;

using Filter = std::array<float, kTaps * kTaps * kTaps>;

/// Minus the Laplacian of a Gaussian of standard deviation 1; sums to 0.
Filter negative_laplacian_of_gaussian() {
    Filter filter{};
    std::array<double, filter.size()> values{};
    double sum = 0.0;
    std::size_t i = 0;
    for (int x = -kReach; x <= kReach; ++x) {
        for (int y = -kReach; y <= kReach; ++y) {
            for (int z = -kReach; z <= kReach; ++z, ++i) {
                const double r2 = x * x + y * y + z * z;
                values[i] = (3.0 - r2) * std::exp(-0.5 * r2);
                sum += values[i];
            }
        }
    }
    for (i = 0; i < filter.size(); ++i) {
        filter[i] = static_cast<float>(values[i] - sum / static_cast<double>(filter.size()));
    }
    return filter;
}

/// index + offset, kept inside [0, size).
std::size_t clamped(std::size_t index, int offset, std::size_t size) {
    const auto moved = static_cast<std::ptrdiff_t>(index) + offset;
    return static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(moved, 0, static_cast<std::ptrdiff_t>(size) - 1));
}

/// One column along z of the filtered volume; voxels beyond its faces repeat those on the faces.
///
/// padded   room for the column and kReach values on either side
void filter_column(const Volume& volume,
                   const Filter& filter,
                   std::size_t column,
                   std::vector<float>& padded,
                   float* out) {
    const std::size_t nx = volume.axes.x_m.size();
    const std::size_t ny = volume.axes.y_m.size();
    const std::size_t nz = volume.axes.z_m.size();
    std::fill_n(out, nz, 0.0F);
    const float* weights = filter.data();
    for (int dx = -kReach; dx <= kReach; ++dx) {
        for (int dy = -kReach; dy <= kReach; ++dy, weights += kTaps) {
            const std::size_t ix = clamped(column / ny, dx, nx);
            const std::size_t iy = clamped(column % ny, dy, ny);
            const float* in = volume.values.data() + volume.index(ix, iy, 0);
            std::copy_n(in, nz, padded.begin() + kReach);
            std::fill_n(padded.begin(), kReach, in[0]);
            std::fill_n(padded.end() - kReach, kReach, in[nz - 1]);
            for (int dz = 0; dz < kTaps; ++dz) {
                const float weight = weights[dz];
                const float* shifted = padded.data() + dz;
                for (std::size_t iz = 0; iz < nz; ++iz) out[iz] += weight * shifted[iz];
            }
        }
    }
}

Volume laplacian_backprojection(const MethodInput& input,
                                const ReconstructSettings& settings,
                                std::size_t num_slabs) {
    const Volume sums = backproject(input, settings, num_slabs);
    const Filter filter = negative_laplacian_of_gaussian();
    const std::size_t nz = sums.axes.z_m.size();
    Volume volume{input.axes, std::vector<float>(sums.values.size()), {}};
    core::parallel_for(sums.axes.x_m.size() * sums.axes.y_m.size(), [&](std::size_t column) {
        std::vector<float> padded(nz + 2 * kReach);
        filter_column(sums, filter, column, padded, volume.values.data() + column * nz);
    });
    return volume;
}

double laplacian_backprojection_bytes(const MethodInput& input,
                                      const ReconstructSettings& settings,
                                      std::size_t num_slabs) {
    return backproject_bytes(input, settings, num_slabs) +
           4.0 * static_cast<double>(input.axes.num_voxels());
}

const MethodTraits kFbpByPhasor{.method = Method::Fbp,
                                .meaning = "backprojection of a virtual wave",
                                .captures = "all",
                                .run = phasor_backprojection,
                                .bytes = phasor_backprojection_bytes,
                                .errors = {kWaveErrors, {}},
                                .explains_gaps = true,
                                .propagates_wave = true,
                                .least_work = least_backprojection_work};

const MethodTraits& row_of_filter(const ReconstructSettings& settings) {
    return settings.filter == FbpFilter::Phasor ? kFbpByPhasor : kFbp;
}

}  // namespace

Volume phasor_backprojection(const MethodInput& input,
                             const ReconstructSettings& settings,
                             std::size_t num_slabs) {
    ReconstructSettings uncompensated = settings;
    uncompensated.compensation = Compensation::None;
    const auto run = [&](WavePart part, double begin, double end) {
        const FilteredHistograms filtered = filter_histograms(input, settings.phasor, part);
        const double all =
            input.observed ? 1.0 / 3.0 : 1.0;  // of the work, the fraction comes after it
        const core::Progress progress = input.progress.part(begin * all, end * all);
        return backproject(with_histograms(input, filtered.time_axis, filtered.transient, progress),
                           uncompensated,
                           num_slabs);
    };
    Volume volume = run(WavePart::Real, 0.0, 0.5);
    const Volume imaginary = run(WavePart::Imaginary, 0.5, 1.0);
    for (std::size_t i = 0; i < volume.values.size(); ++i) {
        volume.values[i] = std::hypot(volume.values[i], imaginary.values[i]);
    }
    if (input.observed) divide_by_observed_fraction(input, num_slabs, volume);
    return volume;
}

double phasor_backprojection_bytes(const MethodInput& input,
                                   const ReconstructSettings& settings,
                                   std::size_t num_slabs) {
    const core::TimeAxis axis = filtered_axis(input.time_axis, settings.phasor);
    return 4.0 * static_cast<double>(input.transient.num_pairs()) * axis.num_bins +
           observed_fraction_bytes(input) +
           laplacian_backprojection_bytes(
               with_histograms(input, axis, input.transient, input.progress), settings, num_slabs);
}

const MethodTraits kFbp{.method = Method::Fbp,
                        .meaning = "filtered backprojection",
                        .captures = "all",
                        .run = laplacian_backprojection,
                        .bytes = laplacian_backprojection_bytes,
                        .errors = {{.model_fraction = 0.055,
                                    .noise_fraction = 0.39,
                                    .doubt = 5.5,
                                    .plateau = {0.0, 0.5}},
                                   {0.0, 0.37}},  // few points leave shells beside a surface
                        .explains_gaps = true,
                        .least_work = least_backprojection_work,
                        .variant = row_of_filter};

}  // namespace nlos
