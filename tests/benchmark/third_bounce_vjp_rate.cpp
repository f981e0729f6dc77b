// SPDX-License-Identifier: MIT
// Time for the third bounce of a bumpy sphere and for its pullback.
//
//   third_bounce_vjp_rate RINGS SIDE REPEATS     2 + RINGS (RINGS + 1) vertices, SIDE^2 points
#include "calib/third_bounce_vjp.h"
#include "renderer/core/stopwatch.h"
#include "tests/support/test_scenes.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace {

using core::Vec3;

// About (0, 0, 0.7), with a radius of 0.25 m that varies by a tenth.
core::TriangleMesh bumpy_sphere(std::uint32_t rings) {
    core::TriangleMesh mesh;
    const std::uint32_t segments = rings + 1;
    const auto add = [&](double polar, double azimuth) {
        const double radius = 0.25 * (1.0 + 0.1 * std::sin(4.0 * polar) * std::cos(3.0 * azimuth));
        const Vec3 direction(std::sin(polar) * std::cos(azimuth),
                             std::sin(polar) * std::sin(azimuth),
                             std::cos(polar));
        mesh.vertices.push_back(Vec3(0.0, 0.0, 0.7) + radius * direction);
    };
    for (std::uint32_t r = 0; r < rings; ++r) {
        for (std::uint32_t s = 0; s < segments; ++s) {
            add(core::kPi * (r + 1) / (rings + 1), 2.0 * core::kPi * s / segments);
        }
    }
    add(0.0, 0.0);
    add(core::kPi, 0.0);
    const std::uint32_t top = rings * segments;
    for (std::uint32_t s = 0; s < segments; ++s) {
        const std::uint32_t next = (s + 1) % segments;
        mesh.triangles.push_back({top, s, next});
        for (std::uint32_t r = 0; r + 1 < rings; ++r) {
            const std::uint32_t row = r * segments;
            const std::uint32_t below = row + segments;
            mesh.triangles.push_back({row + s, below + s, row + next});
            mesh.triangles.push_back({below + next, row + next, below + s});
        }
        const std::uint32_t last = (rings - 1) * segments;
        mesh.triangles.push_back({top + 1, last + next, last + s});
    }
    return mesh;
}

std::vector<Vec3> grid(int side) {
    std::vector<Vec3> positions;
    for (int i = 0; i < side * side; ++i) {
        const double x = (i / side + 0.5) / side - 0.5;
        const double y = (i % side + 0.5) / side - 0.5;
        positions.emplace_back(x, y, 0.0);
    }
    return positions;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 4) {
        fmt::print(stderr, "third_bounce_vjp_rate RINGS SIDE REPEATS\n");
        return 2;
    }
    const core::TriangleMesh mesh = bumpy_sphere(static_cast<std::uint32_t>(std::atoi(argv[1])));
    const core::WallScan scan = test_support::confocal_scan(grid(std::atoi(argv[2])));
    const core::TimeAxis axis{0.6, 0.0048, 300};
    const std::vector<double> albedo(mesh.triangles.size(), 0.5);
    double value_s = 1e9;
    double pullback_s = 1e9;
    for (int i = 0; i < std::atoi(argv[3]); ++i) {
        const core::Stopwatch watch;
        const calib::ThirdBounceVjp vjp(mesh, albedo, scan, axis, {});
        value_s = std::min(value_s, watch.seconds());
        const core::Stopwatch second;
        vjp.pullback(vjp.histograms());
        pullback_s = std::min(pullback_s, second.seconds());
    }
    fmt::print("{} vertices, {} facets, {} pairs, {} bins: value {:.3f} s, pullback {:.3f} s\n",
               mesh.vertices.size(),
               mesh.triangles.size(),
               scan.num_pairs(),
               axis.num_bins,
               value_s,
               pullback_s);
}
