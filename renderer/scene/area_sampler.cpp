// SPDX-License-Identifier: MIT
#include "renderer/scene/area_sampler.h"

namespace renderer {

AreaSampler::AreaSampler(const Scene& scene) : scene_(&scene) {
    std::vector<double> areas;
    for (std::uint32_t i = 0; i < scene.facets().size(); ++i) {
        if (!scene.is_hidden(i)) continue;
        facets_.push_back(i);
        areas.push_back(scene.facet(i).area_m2);
    }
    by_area_ = core::DiscreteDistribution(areas);
}

}  // namespace renderer
