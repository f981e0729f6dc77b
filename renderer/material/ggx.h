// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/simd.h"
#include "renderer/core/types.h"

namespace renderer {

/// Density of GGX normals per solid angle of the normal [1/sr].
///
/// T         double or core::Simd
/// alpha     width
/// cos2      squared cosine of the normal with the facet's
/// sin2      1 - cos2; narrow lobes need it to all digits
/// source    [Walter2007]
template <class T>
[[gnu::always_inline]] inline T ggx_normal_density(const T& alpha, const T& cos2, const T& sin2) {
    const T a2 = alpha * alpha;
    const T scaled = sin2 + a2 * cos2;
    return a2 / (core::kPi * scaled * scaled);
}

/// (1 + 2 Lambda) times the cosine, Lambda being Smith's mean invisible area of the microsurface
/// per visible area in a direction.
///
/// T         double or core::Simd
/// cosine    of the direction with the normal, above 0
/// source    [Heitz2014]
template <class T>
[[gnu::always_inline]] inline T ggx_masking(const T& alpha, const T& cosine) {
    const T a2 = alpha * alpha;
    return core::sqrt(a2 + (1.0 - a2) * (cosine * cosine));
}

/// Value of GgxConductor [1/sr], without cosine.
///
/// T                 double or core::Simd
/// density           ggx_normal_density() of the half vector
/// cos_in, cos_out   of the directions with the normal, above 0
/// cos_half          of either direction with the half vector
/// source            [Walter2007], [Heitz2014], [Schlick1994]; shadowing, 1 + Lambda(in) +
///                   Lambda(out), and the cosines below it are one term
template <class T>
[[gnu::always_inline]] inline T ggx_value(const T& albedo,
                                          const T& alpha,
                                          const T& density,
                                          const T& cos_in,
                                          const T& cos_out,
                                          const T& cos_half) {
    const T visible =
        2.0 * (cos_out * ggx_masking(alpha, cos_in) + cos_in * ggx_masking(alpha, cos_out));
    const T rest = core::max(1.0 - cos_half, 0.0);
    const T rest2 = rest * rest;
    const T fresnel = albedo + (1.0 - albedo) * (rest2 * rest2 * rest);
    return density * fresnel / visible;
}

}  // namespace renderer
