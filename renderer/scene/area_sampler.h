// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/sampling.h"
#include "renderer/scene/scene.h"

#include <cstdint>
#include <vector>

namespace renderer {

/// Draws points uniformly by area on the hidden surfaces of a scene.
///
/// Facets keep the order of the file: it is usually local in space, which keeps the shadow rays of
/// stratified samples coherent (a space-filling curve gained nothing), and rotates with the scene.
class AreaSampler {
 public:
    explicit AreaSampler(const Scene& scene) : scene_(&scene) {
        std::vector<double> areas;
        for (std::uint32_t i = 0; i < scene.facets().size(); ++i) {
            if (!scene.is_hidden(i)) continue;
            facets_.push_back(i);
            areas.push_back(scene.facet(i).area_m2);
        }
        by_area_ = core::DiscreteDistribution(areas);
    }

    SurfacePoint sample(double u1, double u2) const {
        double remapped = 0.0;
        const std::uint32_t facet = facets_[by_area_.sample(u1, remapped)];
        const core::Vec2 b = core::sample_triangle({remapped, u2});
        return {scene_->facet(facet).point(b.x(), b.y()), facet};
    }

    /// For rising numbers: the interval of u1 that holds the next one; see facet_of().
    ///
    /// hint   index of the interval before, at first 0
    core::DiscreteDistribution::Interval interval_from(std::size_t hint, double u1) const {
        return by_area_.interval_from(hint, u1);
    }
    /// Where sample() finds the u1 of a interval; its points there are those of
    /// sample_triangle({interval.remap(u1), u2}).
    std::uint32_t facet_of(const core::DiscreteDistribution::Interval& interval) const {
        return facets_[interval.index];
    }

    /// Density of sample() on hidden facets, pdf_area [1/m^2].
    double pdf_area() const { return 1.0 / by_area_.sum(); }

 private:
    const Scene* scene_;
    std::vector<std::uint32_t> facets_;
    core::DiscreteDistribution by_area_;
};

}  // namespace renderer
