// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/random.h"
#include "renderer/path/path_vertex.h"
#include "renderer/scene/ray_caster.h"

namespace renderer {

/// Directions from a path end, drawn packet by packet: with density cos/pi about the normal of a
/// wall, 1/(4 pi) from an isotropic end [1/sr].
///
/// They are the warps of a shifted lattice, core::lattice_point(). From one of its points to the
/// next the azimuth turns by a constant angle, so that a packet needs one sine and one cosine.
class EndpointDirectionSampler {
 public:
    /// scene, end   must outlive the object
    /// count        of all directions
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
