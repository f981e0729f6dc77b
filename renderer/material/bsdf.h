// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/types.h"

#include <optional>
#include <variant>

namespace renderer {

/// How a facet scatters light. Directions are unit, in the facet's frame (z = normal), pointing
/// away from the surface; both sides scatter, nothing is transmitted, all models are reciprocal.
///
/// Adding a model: a struct here, one overload each of evaluate_, pdf_ and sample_ in bsdf.cpp, and
/// an enumerator of SurfaceModel in material.h for files.

struct Lambertian {
    double albedo = 1.0;
};

/// Rough conductor: GGX normals, height-correlated Smith shadowing, Schlick's Fresnel term with the
/// albedo at normal incidence (source [Walter2007], [Heitz2014], [Schlick1994]).
struct Ggx {
    double albedo = 1.0;
    double alpha = 1.0;  ///< GGX width, the square of glTF's roughness
};

/// Returns light only to where it came from: a distribution that evaluate() cannot hold. The
/// estimators treat it at the third bounce of confocal pairs; for all others it is black.
struct Retroreflective {
    double albedo = 1.0;
};

/// Rough dielectric: GGX reflection at an interface of index 1.5, 0.04 at normal incidence, over a
/// diffuse body that gets what the interface lets in and out. Source [glTF2], appendix B, but for
/// the body's share: there it depends on the half vector, and grazing light comes back as more than
/// all.
struct Dielectric {
    double albedo = 1.0;  ///< of the body
    double alpha = 1.0;   ///< GGX width
};

using Bsdf = std::variant<Lambertian, Ggx, Retroreflective, Dielectric>;

/// Smallest GGX width: narrower lobes are practically mirrors and lose precision.
inline constexpr double kSmallestGgxAlpha = 1e-3;

/// BSDF value [1/sr], without cosine; 0 when the directions lie on different sides.
double evaluate_bsdf(const Bsdf& bsdf, const core::Vec3& incoming, const core::Vec3& outgoing);

/// Density of sample_bsdf() at `outgoing`, pdf_solid_angle [1/sr].
double pdf_bsdf(const Bsdf& bsdf, const core::Vec3& incoming, const core::Vec3& outgoing);

/// Draws an outgoing direction on the side of `incoming` (source [Heitz2018] for GGX); nothing when
/// the draw falls below the surface or the model cannot be sampled.
std::optional<core::Vec3> sample_bsdf(const Bsdf& bsdf,
                                      const core::Vec3& incoming,
                                      const core::Vec2& u);

/// An upper estimate of the reflected share, for Russian roulette.
double albedo_of(const Bsdf& bsdf);

}  // namespace renderer
