// SPDX-License-Identifier: MIT
#include "renderer/area_sampler.h"

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

SurfacePoint AreaSampler::sample(double u1, double u2, std::size_t& hint) const {
    double remapped = 0.0;
    hint = by_area_.sample_from(hint, u1, remapped);
    const core::Vec2 b = core::sample_triangle({remapped, u2});
    const std::uint32_t facet = facets_[hint];
    return {scene_->facet(facet).point(b.x(), b.y()), facet};
}

}  // namespace renderer
