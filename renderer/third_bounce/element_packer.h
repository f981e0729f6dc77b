// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/scene/scene.h"
#include "renderer/third_bounce/surface_elements.h"

#include <vector>

namespace renderer {

/// What packing depends on.
struct PackingRules {
    double tolerance = 0.01;  ///< relative L2 error aimed at
    double laser_spot_m2 = 1e-4;
    std::vector<int> visible_side;  ///< per object, see closed_surface.h
};

/// Merges elements and arranges them into blocks of neighbours and groups within blocks.
///
/// elements   freed, like `clusters`, as soon as they are merged
/// clusters   of elements that may be merged, see cluster_elements()
ElementSet pack_elements(const Scene& scene,
                         const core::Scan& scan,
                         const PackingRules& rules,
                         std::vector<SurfaceElement>&& elements,
                         std::vector<std::uint32_t>&& clusters);

}  // namespace renderer
