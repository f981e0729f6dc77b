// SPDX-License-Identifier: MIT
#include "apps/bench/lower_bounds.h"

#include "nlos/fourier/even_transform.h"
#include "nlos/fourier/padded_plane.h"
#include "nlos/methods/light_cone.h"
#include "nlos/methods/methods.h"
#include "renderer/core/process.h"
#include "renderer/core/random.h"
#include "renderer/scene/area_sampler.h"

#include <algorithm>
#include <vector>

namespace apps {
namespace {

using nlos::Fft;
using nlos::FftBuffer;

constexpr std::size_t kRows = 16;  // at a time, as the methods do

/// CPU time of `count` runs of `work`.
template <class Work>
double time_of(std::size_t count, Work&& work) {
    const double start = core::cpu_seconds();
    for (std::size_t i = 0; i < count; ++i) work();
    return core::cpu_seconds() - start;
}

double row_seconds(const Fft& fft, std::size_t length, std::size_t rows) {
    FftBuffer from(kRows * Fft::row_floats(length));
    FftBuffer to(from.num_floats());
    return time_of((rows + kRows - 1) / kRows, [&] { fft.run(from, to); });
}

std::array<std::size_t, 2> padded_size(const nlos::WallGrid& grid) {
    return {2 * nlos::good_fft_size(grid.size[0]), 2 * nlos::good_fft_size(grid.size[1])};
}

double plane_seconds(const std::array<std::size_t, 2>& filled,
                     const nlos::WallGrid& grid,
                     std::size_t forward,
                     std::size_t inverse) {
    const nlos::PaddedPlane plane(filled, padded_size(grid));
    nlos::PaddedPlane::Workspace work = plane.make_workspace();
    return time_of(forward, [&] { plane.forward(work); }) +
           time_of(inverse, [&] { plane.inverse(work); });
}

double kernel_quadrant_seconds(const nlos::WallGrid& grid, std::size_t count) {
    const auto [px, py] = padded_size(grid);
    const nlos::EvenTransform transform(px / 2 + 1, py / 2 + 1);
    nlos::EvenTransform::Workspace work = transform.make_workspace();
    std::vector<nlos::ComplexF> quadrant((px / 2 + 1) * (py / 2 + 1));
    return time_of(count, [&] { transform.run(quadrant.data(), work); });
}

/// The light-cone transforms' FFTs: every wall point along squared range and its `components` back,
/// every frequency there and its components back laterally, every frequency's kernel and, for more
/// than one component, each one's moment of it.
double light_cone_fft_seconds(const nlos::MethodInput& input, std::size_t components) {
    const nlos::Cone cone = nlos::make_cone(input, 2);
    const nlos::WallGrid& grid = *input.wall.grid;
    const std::size_t frequencies = cone.num_frequencies();
    const auto back = Fft::complex_to_real(cone.length, kRows);
    double seconds =
        row_seconds(Fft::real_to_complex(cone.length, kRows), cone.length, cone.num_columns()) +
        row_seconds(back, cone.length, components * cone.num_columns()) +
        plane_seconds(grid.size, grid, frequencies, components * frequencies) +
        kernel_quadrant_seconds(grid, frequencies);
    if (components > 1) {
        seconds += plane_seconds(padded_size(grid), grid, components * frequencies, 0);
    }
    return seconds;
}

/// Those of f-k migration: every wall point along range, every frequency laterally, every lateral
/// frequency along depth, every depth back laterally.
double fk_fft_seconds(const nlos::MethodInput& input) {
    const nlos::WallGrid& grid = *input.wall.grid;
    const auto bins = static_cast<std::size_t>(input.time_axis.num_bins);
    const std::size_t length = 2 * nlos::good_fft_size(bins);
    const auto [px, py] = padded_size(grid);
    FftBuffer column(2 * length);
    const Fft depth = Fft::complex_batch(length, 1, {1, length}, Fft::Direction::Inverse);
    return row_seconds(Fft::real_to_complex(length, kRows), length, grid.size[0] * grid.size[1]) +
           plane_seconds(grid.size, grid, length / 2 + 1, input.axes.z_m.size()) +
           time_of(px * py, [&] { depth.run(column); });
}

/// Those of the phasor field: for every depth and frequency the kernel and one plane back.
double phasor_fft_seconds(const nlos::MethodInput& input, const nlos::PhasorSettings& settings) {
    const nlos::PhasorTransforms transforms = nlos::phasor_transforms(input, settings);
    const bool is_confocal = input.scan.is_confocal();
    const nlos::WallGrid& grid = *input.wall.grid;
    // Confocal frequencies add up before the way back.
    return plane_seconds(grid.size,
                         grid,
                         transforms.wall,
                         is_confocal ? input.axes.z_m.size() : transforms.planes) +
           kernel_quadrant_seconds(grid, transforms.planes);
}

/// Two multiply-adds for every pair of histogram and voxel.
double multiply_add_seconds(double pairs) {
    constexpr std::size_t kCount = 4096;
    constexpr double kMin = 2e8;  // enough to time; the rest is proportional
    std::vector<float> early(kCount, 1.0F);
    std::vector<float> late(kCount, 0.5F);
    std::vector<float> sums(kCount, 0.0F);
    const auto runs = static_cast<std::size_t>(std::min(pairs, kMin) / kCount) + 1;
    float weight = 0.25F;
    const double seconds = time_of(runs, [&] {
        using Values = Eigen::Map<Eigen::Array<float, Eigen::Dynamic, 1>>;
        Values(sums.data(), kCount) +=
            weight * Values(early.data(), kCount) + (1.0F - weight) * Values(late.data(), kCount);
        weight = -weight;
    });
    return seconds * pairs / (static_cast<double>(runs) * kCount);
}

}  // namespace

double reconstruction_limit_seconds(const core::Capture& capture,
                                    const nlos::Reconstruction& done) {
    const nlos::WallFrame wall = nlos::derive_wall_frame(capture.scan.wall());
    const core::Progress progress;
    const nlos::ReconstructSettings& settings = done.settings;
    const nlos::MethodInput input{capture.scan.wall(),
                                  capture.time_axis,
                                  capture.transient,
                                  wall,
                                  done.volume.axes,
                                  *settings.volume.z_range_m,
                                  progress};
    switch (settings.method) {
        case nlos::Method::Lct:
            return light_cone_fft_seconds(input, 1);
        case nlos::Method::Dlct:
            return light_cone_fft_seconds(input, 3);
        case nlos::Method::Fk:
            return fk_fft_seconds(input);
        case nlos::Method::Phasor:
            return phasor_fft_seconds(input, settings.phasor);
        case nlos::Method::Bp:
        case nlos::Method::Fbp:
            return multiply_add_seconds(static_cast<double>(capture.scan.num_pairs()) *
                                        static_cast<double>(input.axes.num_voxels()));
        case nlos::Method::Auto:
        case nlos::Method::Solver:
            break;
    }
    return 0.0;
}

double shadow_ray_seconds(const renderer::Scene& scene, const core::WallScan& scan) {
    constexpr std::size_t kPoints = 64;
    constexpr std::size_t kLanes = renderer::SegmentPacket::kSize;
    constexpr std::size_t kRays = 128 * kLanes;  // per point
    const renderer::AreaSampler sampler(scene);
    std::vector<renderer::SegmentPacket> packets;
    renderer::SegmentEnds ends;
    for (std::size_t p = 0; p < kPoints; ++p) {
        const std::size_t point = p * scan.sensing.size() / kPoints;
        core::Rng rng(0, p, 0);
        for (std::size_t i = 0; i < kRays; ++i) {
            const double u = (static_cast<double>(i) + rng.uniform()) / kRays;
            const renderer::SurfacePoint place = sampler.sample(u, rng.uniform());
            ends.set(i % kLanes, place.position, scene.facet(place.facet).normal);
            if (i % kLanes != kLanes - 1) continue;
            scene.rays().aim(packets.emplace_back(),
                             scan.sensing.positions[point],
                             scan.sensing.normals[point],
                             ends.lanes(),
                             renderer::SegmentPacket::kSize);
        }
    }
    const double start = core::cpu_seconds();
    for (renderer::SegmentPacket& packet : packets) scene.rays().trace(packet);
    return (core::cpu_seconds() - start) / static_cast<double>(kPoints * kRays);
}

}  // namespace apps
