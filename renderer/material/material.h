// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings.h"
#include "renderer/core/types.h"

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace renderer {

/// What a texture coordinate outside [0, 1) means, per axis.
enum class TextureWrap { Repeat, ClampToEdge, MirroredRepeat };

/// A grey image of linear values, rows from the top.
struct Texture {
    int width = 0;
    int height = 0;
    std::vector<float> luminance;  ///< width * height linear values in [0, 1], row by row
    TextureWrap wrap_u = TextureWrap::Repeat;
    TextureWrap wrap_v = TextureWrap::Repeat;

    /// Bilinear lookup between texel centres.
    ///
    /// uv        texture coordinate as in glTF: (0, 0) is the image's upper left corner
    /// returns   linear value in [0, 1]
    double lookup(const core::Vec2& uv) const;
};

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

/// Linear value of an sRGB-encoded one, both in [0, 1] (source [IEC61966]).
double linear_from_srgb(double encoded);

/// The inverse of linear_from_srgb (source [IEC61966]).
double srgb_from_linear(double linear);

}  // namespace renderer

template <>
struct core::EnumNames<renderer::SurfaceModel> {
    static constexpr auto value = names_from_zero<renderer::SurfaceModel>(
        "lambertian", "ggx conductor", "retroreflective", "ggx dielectric");
};
