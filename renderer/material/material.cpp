// SPDX-License-Identifier: MIT
#include "renderer/material/material.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace renderer {
namespace {

/// Column (or row) of the texel that a wrapped index means; works on doubles because texture
/// coordinates may be far outside the range of an int.
std::size_t wrapped_index(double index, int size, TextureWrap wrap) {
    const double n = size;
    switch (wrap) {
        case TextureWrap::ClampToEdge:
            index = std::clamp(index, 0.0, n - 1.0);
            break;
        case TextureWrap::Repeat:
            index -= n * std::floor(index / n);
            break;
        case TextureWrap::MirroredRepeat:
            index -= 2.0 * n * std::floor(index / (2.0 * n));
            if (index >= n) index = 2.0 * n - 1.0 - index;
            break;
    }
    return static_cast<std::size_t>(std::clamp(index, 0.0, n - 1.0));
}

}  // namespace

double Texture::lookup(const core::Vec2& uv) const {
    const double x = uv.x() * width - 0.5;
    const double y = uv.y() * height - 0.5;
    const double column = std::floor(x);
    const double row = std::floor(y);
    const double fx = x - column;
    const double fy = y - row;
    const auto texel = [&](double i, double j) {
        return static_cast<double>(
            luminance[wrapped_index(j, height, wrap_v) * static_cast<std::size_t>(width) +
                      wrapped_index(i, width, wrap_u)]);
    };
    const double upper = (1.0 - fx) * texel(column, row) + fx * texel(column + 1.0, row);
    const double lower =
        (1.0 - fx) * texel(column, row + 1.0) + fx * texel(column + 1.0, row + 1.0);
    return (1.0 - fy) * upper + fy * lower;
}

double linear_from_srgb(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

double srgb_from_linear(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

Bsdf make_bsdf(const Material& material) {
    return make_bsdf(material.model,
                     material.albedo,
                     std::max(kSmallestGgxAlpha, material.roughness * material.roughness));
}

double mean_albedo(const std::array<double, 3>& linear) {
    return linear[0] + ((linear[1] - linear[0]) + (linear[2] - linear[0])) / 3.0;
}

}  // namespace renderer
