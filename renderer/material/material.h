// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/material/texture.h"

#include <memory>
#include <string>

namespace renderer {

/// How a surface reflects.
enum class SurfaceModel { Lambertian, Ggx, Retroreflective };

struct Material {
    std::string name;
    SurfaceModel model = SurfaceModel::Lambertian;
    double albedo = 1.0;                            ///< in [0, 1]
    double roughness = 1.0;                         ///< in [0, 1]; counts for GGX only
    std::shared_ptr<const Texture> albedo_texture;  ///< multiplies the albedo; null: constant
};

/// True for surfaces whose third bounce the deterministic integrator takes: Lambertian and
/// retroreflective ones, and GGX lobes wide enough to be smooth over an element.
bool is_integrable(const Material& material);

}  // namespace renderer
