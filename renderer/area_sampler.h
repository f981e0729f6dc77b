// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/sampling.h"
#include "renderer/scene.h"

#include <cstdint>
#include <span>
#include <vector>

namespace renderer {

/// Draws points uniformly by area on the hidden surfaces of a scene.
///
/// Facets keep the order of the file: it is usually local in space, which keeps the shadow rays of
/// stratified numbers coherent (a space-filling curve gained nothing), and it turns with the scene.
class AreaSampler {
 public:
    explicit AreaSampler(const Scene& scene);

    SurfacePoint sample(double u1, double u2) const {
        double remapped = 0.0;
        const std::uint32_t facet = facets_[by_area_.sample(u1, remapped)];
        const core::Vec2 b = core::sample_triangle({remapped, u2});
        return {scene_->facet(facet).point(b.x(), b.y()), facet};
    }

    /// The facet of the first of several rising u1 and of all after it that share it.
    struct Run {
        std::uint32_t facet;
        std::size_t size;
    };
    /// hint, u1, remapped   as DiscreteDistribution::sample_run(); start with 0. The points are
    ///                      those of sample_triangle({remapped, u2})
    Run next_run(std::size_t& hint, std::span<const double> u1, std::span<double> remapped) const {
        const std::size_t size = by_area_.sample_run(hint, u1, remapped);
        return {facets_[hint], size};
    }

    /// Density of sample() on hidden facets, pdf_area [1/m^2].
    double pdf_area() const { return 1.0 / by_area_.sum(); }

 private:
    const Scene* scene_;
    std::vector<std::uint32_t> facets_;
    core::DiscreteDistribution by_area_;
};

}  // namespace renderer
