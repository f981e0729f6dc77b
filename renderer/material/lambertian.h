// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/sampling.h"
#include "renderer/material/surface_traits.h"

namespace renderer {

struct Lambertian {
    double albedo = 1.0;

    static constexpr SurfaceTraits kTraits{.name = "lambertian",
                                           .is_constant = true,
                                           .element = ElementResponse{},
                                           .gltf = GltfSurface{}};

    double evaluate(const core::Vec3&, const core::Vec3&) const { return albedo / core::kPi; }
    double pdf(const core::Vec3&, const core::Vec3& outgoing) const {
        return outgoing.z() / core::kPi;
    }
    std::optional<core::Vec3> sample(const core::Vec3&, const core::Vec2& u) const {
        return core::sample_cosine_hemisphere(u);
    }
    double reflects_at_most(double) const { return albedo; }
};

}  // namespace renderer
