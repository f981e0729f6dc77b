// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"

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

/// Linear value of an sRGB-encoded one, both in [0, 1] (source [IEC61966]).
double linear_from_srgb(double encoded);

/// The inverse of linear_from_srgb (source [IEC61966]).
double srgb_from_linear(double linear);

}  // namespace renderer
