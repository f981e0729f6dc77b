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

double mean_albedo(const std::array<double, 3>& linear) {
    return linear[0] + ((linear[1] - linear[0]) + (linear[2] - linear[0])) / 3.0;
}

}  // namespace renderer
