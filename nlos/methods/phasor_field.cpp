// SPDX-License-Identifier: MIT
// Phasor field [Liu2019], [Liu2020]: the relay wall as the lens of a camera for a virtual wave that
// illuminates the hidden scene from the illumination points. The field at a voxel is
//
//     sum over pairs of (H * wave)(|l - p| + |p - s|),
//
// the wave focused at the moment it reaches the voxel. On planar sensing grids it is propagated
// frequency by frequency with the Rayleigh-Sommerfeld kernel by FFT from plane to plane, a group
// of planes at a time: how many frequencies that takes grows with the span of their path lengths.
// Amplitude factors of the propagation are left out. Other scans: phasor_backprojection().
//
// Settings: phasor, whose wavelength_m must be set. Slabs of the frequencies that are propagated.
// The volume is the magnitude of the field.
#include "nlos/fourier/padded_plane.h"
#include "nlos/methods/backprojection.h"
#include "nlos/methods/plane_propagator.h"
#include "nlos/methods/slabs.h"
#include "nlos/methods/virtual_wave.h"
#include "renderer/core/system/large_memory.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <span>

namespace nlos {
namespace {

// Spectra of as many illumination points at a time as fit: fixed, so that sums always come in the
// same order.
constexpr double kSpectrumBytes = 5e8;

/// True when plane-to-plane propagation serves: sensing points on the wall's grid, voxel columns
/// at the same places.
bool is_planar(const MethodInput& input) {
    const std::optional<WallGrid>& grid = input.wall.grid;
    if (!grid || grid->size[0] * grid->size[1] != input.scan.sensing.size()) return false;
    if (input.axes.x_m.size() != grid->size[0] || input.axes.y_m.size() != grid->size[1])
        return false;
    const double tolerance = 1e-6 * std::min(grid->pitch_m[0], grid->pitch_m[1]);
    return std::abs(input.axes.x_m.front() - grid->x_m(0)) < tolerance &&
           std::abs(input.axes.x_m.back() - grid->x_m(grid->size[0] - 1)) < tolerance &&
           std::abs(input.axes.y_m.front() - grid->y_m(0)) < tolerance &&
           std::abs(input.axes.y_m.back() - grid->y_m(grid->size[1] - 1)) < tolerance;
}

/// Planes of voxels that are worked on together, from the same frequencies: the fewer, the shorter
/// the span of their path lengths, which these must tell apart; but threads share a group's planes.
constexpr std::size_t kPlanesPerGroup = 32;

std::vector<Slab> plane_groups(const MethodInput& input) {
    const std::size_t num_planes = input.axes.z_m.size();
    return split_into_slabs(num_planes, largest_slab(num_planes, kPlanesPerGroup));
}

/// Shortest and longest path length from the wall over a group of planes to the wall, from bounds
/// of points and voxels.
std::array<double, 2> path_lengths(const MethodInput& input, const Slab& planes) {
    const double near_m = input.axes.z_m[planes.begin];
    const double far_m = input.axes.z_m[planes.end - 1];
    const double wide = std::max(input.wall.max_m[0], input.axes.x_m.back()) -
                        std::min(input.wall.min_m[0], input.axes.x_m.front());
    const double high = std::max(input.wall.max_m[1], input.axes.y_m.back()) -
                        std::min(input.wall.min_m[1], input.axes.y_m.front());
    const double longest_back = std::sqrt(wide * wide + high * high + far_m * far_m);
    const bool is_confocal = input.scan.is_confocal();
    double longest_out = is_confocal ? longest_back : 0.0;
    for (const core::Vec3& point : illumination_of(input)) {
        for (const double x : {input.axes.x_m.front(), input.axes.x_m.back()}) {
            for (const double y : {input.axes.y_m.front(), input.axes.y_m.back()}) {
                const core::Vec3 corner(x, y, far_m);
                longest_out = std::max(longest_out, (corner - point).norm());
            }
        }
    }
    return {2.0 * near_m, longest_out + longest_back};
}

/// The wave and the bins that can reach a voxel.
struct Band {
    VirtualWave wave;
    core::BinRange bins;
};

Band make_band(const MethodInput& input, const Slab& planes, const PhasorSettings& settings) {
    const core::TimeAxis& axis = input.time_axis;
    const std::array<double, 2> segments = core::device_segment_range_m(input.scan);
    const double shortest_segment = segments[0];
    const double longest_segment = segments[1];
    const double reach = 4.0 * settings.cycles * *settings.wavelength_m / 6.0;
    const auto [shortest, longest] = path_lengths(input, planes);
    const auto bin_at = [&](double opl) {
        const double bin = std::floor((opl - axis.opl_start_m) / axis.bin_width_m);
        return static_cast<int>(std::clamp(bin, 0.0, static_cast<double>(axis.num_bins)));
    };
    Band band;
    band.bins = {bin_at(shortest + shortest_segment - reach),
                 bin_at(longest + longest_segment + reach)};
    const double begin = axis.bin_begin_m(band.bins.begin) - longest_segment;
    const double end = axis.bin_begin_m(band.bins.end) - shortest_segment;
    band.wave = make_virtual_wave(settings, std::max(longest - begin, end - shortest));
    return band;
}

std::size_t illumination_count(const MethodInput& input) {
    return input.scan.pattern == core::ScanPattern::Exhaustive ? input.scan.illumination.size() : 1;
}

/// How many illumination points' spectra are held at a time.
///
/// num_frequencies   of each
std::size_t illumination_per_chunk(const MethodInput& input,
                                   std::size_t num_frequencies,
                                   std::size_t spectrum_size,
                                   std::size_t num_slabs) {
    const double bytes = 8.0 * static_cast<double>(num_frequencies * spectrum_size * num_slabs);
    const auto fitting = static_cast<std::size_t>(std::max(1.0, kSpectrumBytes / bytes));
    return std::min(illumination_count(input), fitting);
}

/// Adds what a wave, or a part of one, brings to planes of voxels to `field` [z][x][y].
///
/// chunk   illumination points at a time
void add_wave(const MethodInput& input,
              std::span<const double> z_m,
              const VirtualWave& wave,
              const core::BinRange& bins,
              std::size_t chunk,
              const core::Progress& progress,
              std::vector<ComplexF>& field) {
    const PlanePropagator propagator(input, wave);
    const std::size_t num_columns = propagator.num_columns();
    const std::size_t num_illumination = illumination_count(input);
    for (std::size_t first = 0; first < num_illumination; first += chunk) {
        const std::size_t end = std::min(num_illumination, first + chunk);
        const std::vector<ComplexF> spectra = propagator.spectra(
            analyse(input, wave, bins, {first * num_columns, end * num_columns}), end - first);
        const auto fraction = [&](std::size_t done) {
            return static_cast<double>(done) / static_cast<double>(num_illumination);
        };
        parallel_blocks_with_progress(
            z_m.size(),
            1,
            {progress, fraction(first), fraction(end), "propagation"},
            [&](std::size_t iz, std::size_t) {
                std::vector<ComplexF> plane(num_columns);
                propagator.add_plane(z_m[iz], spectra, {first, end}, plane);
                for (std::size_t i = 0; i < num_columns; ++i) {
                    field[iz * num_columns + i] += plane[i];
                }
            });
    }
}

/// Fills a group of planes of the volume.
void propagate_to(const Slab& planes,
                  const MethodInput& input,
                  const PhasorSettings& settings,
                  std::size_t num_slabs,
                  Volume& volume) {
    const std::size_t num_z = input.axes.z_m.size();
    const Band band = make_band(input, planes, settings);
    const core::Progress progress = planes.part_of(input.progress, num_z);
    const std::size_t num_columns = input.axes.x_m.size() * input.axes.y_m.size();
    const std::size_t num_frequencies = band.wave.size();
    const std::size_t chunk = illumination_per_chunk(
        input, largest_slab(num_frequencies, num_slabs), padded_size(*input.wall.grid), num_slabs);

    std::vector<ComplexF> field(num_columns * planes.size());  // [z][x][y]
    for (const Slab& slab : split_into_slabs(num_frequencies, num_slabs)) {
        add_wave(input,
                 {input.axes.z_m.data() + planes.begin, planes.size()},
                 band.wave.part(slab.begin, slab.end),
                 band.bins,
                 chunk,
                 slab.part_of(progress, num_frequencies),
                 field);
    }
    for (std::size_t column = 0; column < num_columns; ++column) {
        for (std::size_t iz = planes.begin; iz < planes.end; ++iz) {
            volume.values[column * num_z + iz] =
                magnitude(field[(iz - planes.begin) * num_columns + column]);
        }
    }
}

Volume phasor_field(const MethodInput& input,
                    const ReconstructSettings& settings,
                    std::size_t num_slabs) {
    if (!is_planar(input)) return phasor_backprojection(input, settings, num_slabs);
    Volume volume{input.axes, core::zeros(input.axes.num_voxels()), {}};
    for (const Slab& planes : plane_groups(input)) {
        propagate_to(planes, input, settings.phasor, num_slabs, volume);
    }
    return volume;
}

/// How much is transformed laterally on a planar grid, per illumination point.
struct PhasorTransforms {
    std::size_t wall = 0;              ///< frequencies at the wall
    std::size_t planes = 0;            ///< frequencies at planes of voxels
    std::size_t most_frequencies = 0;  ///< that serve one plane
};

PhasorTransforms phasor_transforms(const MethodInput& input, const PhasorSettings& settings) {
    PhasorTransforms transforms;
    for (const Slab& planes : plane_groups(input)) {
        const std::size_t num_frequencies = make_band(input, planes, settings).wave.size();
        transforms.wall += num_frequencies;
        transforms.planes += num_frequencies * planes.size();
        transforms.most_frequencies = std::max(transforms.most_frequencies, num_frequencies);
    }
    return transforms;
}

double phasor_field_bytes(const MethodInput& input,
                          const ReconstructSettings& settings,
                          std::size_t num_slabs) {
    if (!is_planar(input)) return phasor_backprojection_bytes(input, settings, num_slabs);
    const auto [nx, ny] = input.wall.grid->size;
    const std::size_t padded = padded_size(*input.wall.grid);
    const std::size_t size =
        largest_slab(phasor_transforms(input, settings.phasor).most_frequencies, num_slabs);
    const auto chunk = static_cast<double>(illumination_per_chunk(input, size, padded, num_slabs));
    const double spectra =
        8.0 * chunk * static_cast<double>(size) * static_cast<double>(padded + nx * ny);
    const double per_thread =
        8.0 * static_cast<double>(padded) * 6.5 + 16.0 * chunk * static_cast<double>(nx * ny);
    return spectra + per_thread * core::thread_count() +
           8.0 * static_cast<double>(nx * ny * kPlanesPerGroup) +
           4.0 * static_cast<double>(input.axes.num_voxels());
}

/// For every depth and frequency the kernel and one plane back; confocal frequencies add up before
/// the way back.
LeastWork least_phasor_work(const MethodInput& input, const ReconstructSettings& settings) {
    const PhasorTransforms transforms = phasor_transforms(input, settings.phasor);
    const bool is_confocal = input.scan.is_confocal();
    return {.planes_forward = transforms.wall,
            .planes_inverse = is_confocal ? input.axes.z_m.size() : transforms.planes,
            .even_planes = transforms.planes};
}

constexpr std::size_t kMinSensingPoints = 4;

std::string why_too_few_points(const PreparedCapture& prepared, const VolumeSettings& /*volume*/) {
    const std::size_t points = prepared.scan.sensing.size();
    return points < kMinSensingPoints ? fmt::format("{} sensing points", points) : "";
}

constexpr MethodNeeds kSensingPoints{.text = "at least 4 sensing points",
                                     .met = "scan of several points",
                                     .obstacle = why_too_few_points};

}  // namespace

const MethodTraits kPhasor{.method = Method::Phasor,
                           .meaning = "phasor field, Rayleigh-Sommerfeld propagation",
                           .captures = "all",
                           .run = phasor_field,
                           .bytes = phasor_field_bytes,
                           .errors = {kWaveErrors, {}},
                           .needs = &kSensingPoints,
                           .propagates_wave = true,
                           .least_work = least_phasor_work};

}  // namespace nlos
