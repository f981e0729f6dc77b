// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"
#include "renderer/material/surface_traits.h"

namespace renderer {

/// Returns light only to where it came from.
struct Retroreflective {
    double albedo = 1.0;

    static constexpr SurfaceTraits kTraits{.name = "retroreflective",
                                           .returns_to_source = true,
                                           .element = ElementResponse{.towards_source = true},
                                           .gltf = GltfSurface{.retroreflective = true}};

    double evaluate(const core::Vec3&, const core::Vec3&) const { return 0.0; }
    double pdf(const core::Vec3&, const core::Vec3&) const { return 0.0; }
    std::optional<core::Vec3> sample(const core::Vec3&, const core::Vec2&) const {
        return std::nullopt;
    }
    double reflects_at_most(double) const { return albedo; }
};

}  // namespace renderer
