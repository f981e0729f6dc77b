// SPDX-License-Identifier: MIT
#include "renderer/material/material.h"

namespace renderer {

// Narrower GGX lobes are left to Monte Carlo.
constexpr double kSmallestGlossyAlpha = 0.03;

bool is_integrable(const Material& material) {
    if (material.model == SurfaceModel::Dielectric) return false;
    return material.model != SurfaceModel::Ggx ||
           material.roughness * material.roughness >= kSmallestGlossyAlpha;
}

}  // namespace renderer
