// SPDX-License-Identifier: MIT
#include "apps/bench/lower_bounds.h"

#include "nlos/fourier/even_transform.h"
#include "nlos/fourier/padded_plane.h"
#include "nlos/methods/methods.h"
#include "renderer/core/random.h"
#include "renderer/core/system/process.h"
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

/// Real transforms in batches, or complex ones one by one.
double row_seconds(const nlos::LeastWork& work) {
    const std::size_t length = work.row_length;
    if (length == 0) return 0.0;
    const Fft forward = Fft::real_to_complex(length, kRows);
    const Fft inverse = Fft::complex_to_real(length, kRows);
    const Fft complex = Fft::complex_batch(length, 1, {1, length}, Fft::Direction::Inverse);
    FftBuffer from(kRows * Fft::row_floats(length));
    FftBuffer to(from.num_floats());
    FftBuffer column(2 * length);
    return time_of((work.rows_forward + kRows - 1) / kRows, [&] { forward.run(from, to); }) +
           time_of((work.rows_inverse + kRows - 1) / kRows, [&] { inverse.run(from, to); }) +
           time_of(work.complex_rows, [&] { complex.run(column); });
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

double seconds_of(const nlos::LeastWork& work, const nlos::WallFrame& wall) {
    const double seconds = row_seconds(work) + multiply_add_seconds(work.multiply_adds);
    if (!wall.grid) return seconds;
    const nlos::WallGrid& grid = *wall.grid;
    return seconds + plane_seconds(grid.size, grid, work.planes_forward, work.planes_inverse) +
           plane_seconds(padded_size(grid), grid, work.filled_planes, 0) +
           kernel_quadrant_seconds(grid, work.even_planes);
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
    const nlos::MethodTraits& method = nlos::traits_of(settings);
    return method.least_work ? seconds_of(method.least_work(input, settings), wall) : 0.0;
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
            const renderer::SurfacePoint end = sampler.sample(u, rng.uniform());
            ends.set(i % kLanes, end.position, scene.facet(end.facet).normal);
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
