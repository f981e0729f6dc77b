// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/settings/settings.h"
#include "renderer/material/ggx_conductor.h"
#include "renderer/material/ggx_dielectric.h"
#include "renderer/material/lambertian.h"
#include "renderer/material/retroreflective.h"

#include <array>
#include <cstdint>
#include <variant>

namespace renderer {

/// How a facet scatters light. Directions are unit, in the facet's frame (z = normal), pointing
/// away from the surface; both sides scatter, nothing is transmitted, all models are reciprocal.
///
/// This is the list of all surface models. Adding one: a file like ggx_conductor.h, and its name
/// here; a model that is not a constant or a GGX lobe needs no more than that. The functions of a
/// model see both directions above the surface. `reflects_at_most` bounds what it reflects of light
/// that comes at an angle of that cosine, and `lobe_fraction` is the part of the samples that
/// follow the lobe, where there is one. The first model is that of materials of which nothing is
/// said.
using Bsdf = std::variant<Lambertian, GgxConductor, Retroreflective, GgxDielectric>;

/// A surface model without its parameters: an index into that list.
enum class SurfaceModel : std::uint8_t {};

inline constexpr std::size_t kNumSurfaceModels = std::variant_size_v<Bsdf>;

inline constexpr std::array<SurfaceTraits, kNumSurfaceModels> kSurfaceTraits =
    []<class... Models>(const std::variant<Models...>*) {
        return std::array{Models::kTraits...};
    }(static_cast<const Bsdf*>(nullptr));

inline const SurfaceTraits& traits_of(SurfaceModel model) {
    return kSurfaceTraits[static_cast<std::size_t>(model)];
}
inline const SurfaceTraits& traits_of(const Bsdf& bsdf) {
    return kSurfaceTraits[bsdf.index()];
}

/// The model that files mean.
SurfaceModel model_of(const GltfSurface& surface);

/// Names of the models for which a predicate of their traits holds, as a message lists them.
std::string model_names(bool (*holds)(const SurfaceTraits&));

/// Smallest GGX width: narrower lobes are practically mirrors and lose precision.
inline constexpr double kSmallestGgxAlpha = 1e-3;

/// A model with its parameters.
///
/// alpha   GGX width, for models that have a lobe
Bsdf make_bsdf(SurfaceModel model, double albedo, double alpha);

/// BSDF value [1/sr], without cosine; 0 when the directions lie on different sides.
double evaluate_bsdf(const Bsdf& bsdf, const core::Vec3& incoming, const core::Vec3& outgoing);

/// Density of sample_bsdf() at `outgoing`, pdf_solid_angle [1/sr].
double pdf_bsdf(const Bsdf& bsdf, const core::Vec3& incoming, const core::Vec3& outgoing);

/// Draws an outgoing direction on the side of `incoming`; nothing when the draw falls below the
/// surface or the model cannot be sampled.
std::optional<core::Vec3> sample_bsdf(const Bsdf& bsdf,
                                      const core::Vec3& incoming,
                                      const core::Vec2& u);

/// The albedo as scenes state it: of the diffuse body, or at normal incidence.
inline double albedo_of(const Bsdf& bsdf) {
    return std::visit([](const auto& model) { return model.albedo; }, bsdf);
}

/// An upper bound of the fraction of light that a surface reflects, from a direction on either side
/// that makes an angle of this cosine with the normal.
double reflects_at_most(const Bsdf& bsdf, double cosine);

/// Value [1/sr] where it is the same for all pairs of directions on one side. Samples are then
/// distributed as the cosine.
inline std::optional<double> constant_value(const Bsdf& bsdf) {
    if (!traits_of(bsdf).is_constant) return std::nullopt;
    return albedo_of(bsdf) / core::kPi;
}

/// Fraction of the light that goes back to where it came from, of models that do just that.
inline std::optional<double> returned_to_source(const Bsdf& bsdf) {
    if (!traits_of(bsdf).returns_to_source) return std::nullopt;
    return albedo_of(bsdf);
}

/// A lobe about the mirrored direction.
struct Lobe {
    double alpha = 1.0;     ///< GGX width
    double fraction = 1.0;  ///< of the samples of a direction that follow it
};

/// The lobe for light that comes at an angle of this cosine; nothing: there is none.
std::optional<Lobe> lobe_of(const Bsdf& bsdf, double cosine);

/// How the surface's elements answer in the third-bounce integrator; nothing where it leaves third
/// bounces to paths.
std::optional<ElementResponse> element_response(const Bsdf& bsdf);

}  // namespace renderer

template <>
struct core::EnumNames<renderer::SurfaceModel> {
    static constexpr auto value = [] {
        std::array<std::pair<renderer::SurfaceModel, std::string_view>, renderer::kNumSurfaceModels>
            names{};
        for (std::size_t i = 0; i < names.size(); ++i) {
            names[i] = {static_cast<renderer::SurfaceModel>(i), renderer::kSurfaceTraits[i].name};
        }
        return names;
    }();
};
