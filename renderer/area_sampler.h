// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/sampling.h"
#include "renderer/scene.h"

#include <cstdint>
#include <vector>

namespace renderer {

/// Draws points uniformly by area on the hidden surfaces of a scene.
///
/// Facets keep the order of the file: it is usually local in space, which keeps the shadow rays of
/// stratified numbers coherent (a space-filling curve gained nothing), and it turns with the scene.
class AreaSampler {
 public:
    explicit AreaSampler(const Scene& scene);

    /// A surface point; `hint` is updated so that calls with rising u1 are quick (start with 0).
    SurfacePoint sample(double u1, double u2, std::size_t& hint) const {
        double remapped = 0.0;
        hint = by_area_.sample_from(hint, u1, remapped);
        const core::Vec2 b = core::sample_triangle({remapped, u2});
        const std::uint32_t facet = facets_[hint];
        return {scene_->facet(facet).point(b.x(), b.y()), facet};
    }

    /// Density of sample() on hidden facets, pdf_area [1/m^2].
    double pdf_area() const { return 1.0 / by_area_.sum(); }

 private:
    const Scene* scene_;
    std::vector<std::uint32_t> facets_;
    core::DiscreteDistribution by_area_;
};

}  // namespace renderer
