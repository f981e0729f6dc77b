// SPDX-License-Identifier: MIT
#include "renderer/path/endpoint_direction_sampler.h"

#include "renderer/core/sampling.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace renderer {
namespace {

using core::kPi;
using core::Vec2;

constexpr int kSize = DirectionPacket::kSize;

// Cosines and sines of the azimuths of a packet's lattice points, relative to the first one.
struct Turns {
    Turns() {
        for (int i = 0; i < kSize; ++i) {
            const double angle = 2.0 * kPi * core::lattice_point(i, kSize, {0.0, 0.0}).y();
            cosine[static_cast<std::size_t>(i)] = std::cos(angle);
            sine[static_cast<std::size_t>(i)] = std::sin(angle);
        }
    }
    alignas(64) std::array<double, kSize> cosine;
    alignas(64) std::array<double, kSize> sine;
};
const Turns kTurns;

}  // namespace

EndpointDirectionSampler::EndpointDirectionSampler(const Scene& scene,
                                                   const PathEndpoint& end,
                                                   int count,
                                                   core::Rng& rng)
    : end_(end),
      world_from_end_(core::frame_from_normal(end.normal, scene.tangent_hint(end.normal))),
      count_(count) {
    shift_.x() = rng.uniform();
    shift_.y() = rng.uniform();
}

void EndpointDirectionSampler::next(DirectionPacket& packet) {
    const double first = 2.0 * kPi * core::lattice_point(begin_, count_, shift_).y();
    const double cosine = std::cos(first);
    const double sine = std::sin(first);
    const double isotropic = end_.isotropic ? 1.0 : 0.0;
    const core::Mat3 m = world_from_end_;
    const double begin = begin_ + shift_.x();
    const double width = 1.0 / count_;
    for (int lane = 0; lane < kSize; ++lane) {
        const auto i = static_cast<std::size_t>(lane);
        // Lanes beyond the last direction get arbitrary ones.
        const double u = std::min((begin + lane) * width, core::kBelowOne);
        const double z = isotropic * (1.0 - 2.0 * u) + (1.0 - isotropic) * std::sqrt(1.0 - u);
        const double radius = std::sqrt(u * (1.0 - isotropic + isotropic * 4.0 * (1.0 - u)));
        const double x = radius * (cosine * kTurns.cosine[i] - sine * kTurns.sine[i]);
        const double y = radius * (sine * kTurns.cosine[i] + cosine * kTurns.sine[i]);
        packet.x[i] = m(0, 0) * x + m(0, 1) * y + m(0, 2) * z;
        packet.y[i] = m(1, 0) * x + m(1, 1) * y + m(1, 2) * z;
        packet.z[i] = m(2, 0) * x + m(2, 1) * y + m(2, 2) * z;
    }
    packet.count = std::min(count_ - begin_, kSize);
    begin_ += packet.count;
}

}  // namespace renderer
