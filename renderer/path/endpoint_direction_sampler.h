// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/random.h"
#include "renderer/path/path_vertex.h"
#include "renderer/scene/ray_caster.h"

namespace renderer {

/// Draws directions from a path end, packet by packet: cosine-weighted about the normal of a wall,
/// uniform from an isotropic end.
///
/// The directions are warped from a randomly shifted lattice, core::lattice_point(). From one of
/// its points to the next the azimuth advances by a constant angle, so that a packet needs one sine
/// and one cosine.
class EndpointDirectionSampler {
 public:
    /// scene, end   must outlive the object
    /// count        of directions in all packets
    EndpointDirectionSampler(const Scene& scene,
                             const PathEndpoint& end,
                             int count,
                             core::Rng& rng);

    const PathEndpoint& end() const { return end_; }
    bool done() const { return begin_ == count_; }
    /// Sets count, x, y and z of a packet; not to be called when done().
    void next(DirectionPacket& packet);

 private:
    const PathEndpoint& end_;
    core::Mat3 world_from_end_;
    int count_;
    int begin_ = 0;
    core::Vec2 shift_;
};

}  // namespace renderer
