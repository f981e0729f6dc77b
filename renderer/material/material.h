// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings.h"
#include "renderer/material/texture.h"

#include <array>
#include <memory>
#include <string>

namespace renderer {

/// How a surface reflects.
enum class SurfaceModel { Lambertian, Ggx, Retroreflective, Dielectric };

struct Material {
    std::string name;
    SurfaceModel model = SurfaceModel::Lambertian;
    double albedo = 1.0;                            ///< in [0, 1]
    double roughness = 1.0;                         ///< in [0, 1]; of GGX lobes
    std::shared_ptr<const Texture> albedo_texture;  ///< multiplies the albedo; null: constant
};

/// True for surfaces whose third bounce the deterministic integrator takes: Lambertian and
/// retroreflective ones, and conductors with GGX lobes wide enough to be smooth over an element.
bool is_integrable(const Material& material);

/// What a linear colour counts as: its mean over red, green and blue; equal components keep their
/// value to the last bit.
double mean_albedo(const std::array<double, 3>& linear);

}  // namespace renderer

template <>
struct core::EnumNames<renderer::SurfaceModel> {
    static constexpr auto value = names_from_zero<renderer::SurfaceModel>(
        "lambertian", "ggx conductor", "retroreflective", "ggx dielectric");
};
