// SPDX-License-Identifier: MIT
#include "apps/bench/limits.h"

#include "nlos/light_cone.h"
#include "nlos/padded_plane.h"
#include "nlos/phasor_field.h"
#include "renderer/area_sampler.h"
#include "renderer/core/process.h"
#include "renderer/core/random.h"

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
    FftBuffer buffer(kRows * (length + 2));
    return time_of((rows + kRows - 1) / kRows, [&] { fft.run(buffer); });
}

std::array<std::size_t, 2> padded_size(const nlos::WallGrid& grid) {
    return {2 * nlos::good_fft_size(grid.size[0]), 2 * nlos::good_fft_size(grid.size[1])};
}

double plane_seconds(const nlos::WallGrid& grid, std::size_t forward, std::size_t inverse) {
    const nlos::PaddedPlane plane(grid.size, padded_size(grid));
    nlos::PaddedPlane::Workspace work = plane.make_workspace();
    return time_of(forward, [&] { plane.forward(work); }) +
           time_of(inverse, [&] { plane.inverse(work); });
}

double kernel_seconds(const nlos::WallGrid& grid, std::size_t count) {
    const auto [px, py] = padded_size(grid);
    const Fft fft = Fft::even_2d(px / 2 + 1, py / 2 + 1);
    FftBuffer quadrant(2 * (px / 2 + 1) * (py / 2 + 1));
    return time_of(count, [&] { fft.run(quadrant); });
}

}  // namespace

double light_cone_fft_seconds(const nlos::MethodInput& input) {
    const nlos::Cone cone = nlos::make_cone(input, 2);
    const nlos::WallGrid& grid = *input.wall.grid;
    const std::size_t frequencies = cone.num_frequencies();
    return row_seconds(Fft::real_to_complex(cone.length, kRows), cone.length, cone.num_columns()) +
           row_seconds(Fft::complex_to_real(cone.length, kRows), cone.length, cone.num_columns()) +
           plane_seconds(grid, frequencies, frequencies) + kernel_seconds(grid, frequencies);
}

double fk_fft_seconds(const nlos::MethodInput& input) {
    const nlos::WallGrid& grid = *input.wall.grid;
    const auto bins = static_cast<std::size_t>(input.time_axis.num_bins);
    const std::size_t length = 2 * nlos::good_fft_size(bins);
    const auto [px, py] = padded_size(grid);
    FftBuffer column(2 * length);
    const Fft depth = Fft::complex_batch({length, 1, 1, length}, Fft::Direction::Inverse);
    return row_seconds(Fft::real_to_complex(length, kRows), length, grid.size[0] * grid.size[1]) +
           plane_seconds(grid, length / 2 + 1, input.axes.z_m.size()) +
           time_of(px * py, [&] { depth.run(column); });
}

double phasor_fft_seconds(const nlos::MethodInput& input, const nlos::PhasorSettings& settings) {
    const std::size_t frequencies = nlos::phasor_frequency_count(input, settings);
    const std::size_t planes = frequencies * input.axes.z_m.size();
    const bool is_confocal = input.scan.pattern == core::ScanPattern::Confocal;
    const nlos::WallGrid& grid = *input.wall.grid;
    // Confocal frequencies add up before the way back.
    return plane_seconds(grid, frequencies, is_confocal ? input.axes.z_m.size() : planes) +
           kernel_seconds(grid, planes);
}

double multiply_add_seconds(double pairs) {
    constexpr std::size_t kCount = 4096;
    constexpr double kFewest = 2e8;  // enough to time; the rest is proportional
    std::vector<float> early(kCount, 1.0F);
    std::vector<float> late(kCount, 0.5F);
    std::vector<float> sums(kCount, 0.0F);
    const auto runs = static_cast<std::size_t>(std::min(pairs, kFewest) / kCount) + 1;
    float weight = 0.25F;
    const double seconds = time_of(runs, [&] {
        using Values = Eigen::Map<Eigen::Array<float, Eigen::Dynamic, 1>>;
        Values(sums.data(), kCount) +=
            weight * Values(early.data(), kCount) + (1.0F - weight) * Values(late.data(), kCount);
        weight = -weight;
    });
    return seconds * pairs / (static_cast<double>(runs) * kCount);
}

double shadow_ray_seconds(const renderer::Scene& scene, const core::Scan& scan) {
    constexpr std::size_t kPoints = 64;
    constexpr std::size_t kRays = 2048;  // per point
    const renderer::AreaSampler sampler(scene);
    std::vector<renderer::SegmentPacket> packets;
    for (std::size_t p = 0; p < kPoints; ++p) {
        const std::size_t point = p * scan.sensing.size() / kPoints;
        core::Rng rng(0, p, 0);
        std::size_t hint = 0;
        for (std::size_t i = 0; i < kRays; ++i) {
            const double u = (static_cast<double>(i) + rng.uniform()) / kRays;
            const renderer::SurfacePoint place = sampler.sample(u, rng.uniform(), hint);
            if (packets.empty() || packets.back().full() || i == 0) packets.emplace_back();
            scene.rays().add_segment(packets.back(),
                                     scan.sensing.positions[point],
                                     scan.sensing.normals[point],
                                     place.position,
                                     scene.facet(place.facet).normal);
        }
    }
    const double start = core::cpu_seconds();
    for (renderer::SegmentPacket& packet : packets) scene.rays().trace(packet);
    return (core::cpu_seconds() - start) / static_cast<double>(kPoints * kRays);
}

}  // namespace apps
