// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/material/bsdf.h"

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
struct Material {
    std::string name;
    SurfaceModel model{};
    double albedo = 1.0;                            ///< in [0, 1]
    double roughness = 1.0;                         ///< in [0, 1]; of models that have a lobe
    std::shared_ptr<const Texture> albedo_texture;  ///< multiplies the albedo; null: constant
};

/// The BSDF of a material, where it has a texture that of the texture's white.
Bsdf make_bsdf(const Material& material);

/// True for surfaces whose third bounce the third-bounce integrator takes.
inline bool is_integrable(const Material& material) {
    return element_response(make_bsdf(material)).has_value();
}

/// False for surfaces that reflect nothing at all.
inline bool reflects(const Material& material) {
    return material.albedo > 0.0 || traits_of(material.model).reflects_when_black;
}

/// What a linear colour counts as: its mean over red, green and blue; equal components keep their
/// value to the last bit.
double mean_albedo(const std::array<double, 3>& linear);

/// Linear value of an sRGB-encoded one, both in [0, 1] (source [IEC61966]).
double linear_from_srgb(double encoded);

/// The inverse of linear_from_srgb (source [IEC61966]).
double srgb_from_linear(double linear);

}  // namespace renderer
