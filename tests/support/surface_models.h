// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/material/material.h"

#include <algorithm>
#include <cctype>
#include <string>
#include <vector>

namespace test_support {

/// One material of every surface model, named after it.
inline std::vector<renderer::Material> materials_of_all_models(double albedo, double roughness) {
    std::vector<renderer::Material> materials;
    for (const auto& [model, name] : core::EnumNames<renderer::SurfaceModel>::value) {
        materials.push_back({std::string(name), model, albedo, roughness, nullptr});
    }
    return materials;
}

/// The BSDFs of every model, with the albedos and, where it has a lobe, the GGX widths given.
inline std::vector<renderer::Bsdf> bsdfs_of_all_models(const std::vector<double>& albedos,
                                                       const std::vector<double>& alphas) {
    std::vector<renderer::Bsdf> bsdfs;
    for (const auto& [model, name] : core::EnumNames<renderer::SurfaceModel>::value) {
        const bool has_lobe = renderer::traits_of(model).has_lobe;
        for (const double albedo : albedos) {
            for (std::size_t i = 0; i < (has_lobe ? alphas.size() : 1); ++i) {
                bsdfs.push_back(renderer::make_bsdf(model, albedo, alphas[i]));
            }
        }
    }
    return bsdfs;
}

/// Model, albedo and width, for messages.
inline std::string bsdf_text(const renderer::Bsdf& bsdf) {
    const auto lobe = renderer::lobe_of(bsdf, 1.0);
    return std::string(renderer::traits_of(bsdf).name) + ", albedo " +
           std::to_string(renderer::albedo_of(bsdf)) +
           (lobe ? ", alpha " + std::to_string(lobe->alpha) : "");
}

}  // namespace test_support
