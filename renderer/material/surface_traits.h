// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string_view>

namespace renderer {

/// How an element of a surface answers the two ends of a path in the third-bounce integrator;
/// neither: alike in all directions.
struct ElementResponse {
    bool towards_source = false;  ///< sends light back to where it came from, and nowhere else
    bool glossy = false;          ///< by ggx_value() at the nodes of the element

    bool operator==(const ElementResponse&) const = default;
};

/// What glTF, our extras and settings say of how a surface reflects.
struct GltfSurface {
    bool metallic = false;         ///< metallicFactor above 0
    bool retroreflective = false;  ///< extras nlos_retroreflective
    bool specular = false;         ///< the interface of dielectrics, render.dielectric_specular

    bool operator==(const GltfSurface&) const = default;
};

/// What estimators, fits and files ask of a surface model. Every model gives its own.
struct SurfaceTraits {
    std::string_view name;  ///< in scene.json
    /// The value is albedo/pi in all directions, and samples are distributed as the cosine.
    bool is_constant = false;
    /// The albedo goes back to where the light came from: a distribution that no value can hold.
    /// Estimators treat it at the third bounce of pairs whose ends coincide; elsewhere it is black.
    bool returns_to_source = false;
    /// Has a GGX lobe of width `alpha` about the mirrored direction.
    bool has_lobe = false;
    bool reflects_when_black = false;  ///< reflects some light even when the albedo is 0
    /// In the third-bounce integrator; nothing: third bounces are left to paths.
    std::optional<ElementResponse> element = std::nullopt;
    /// What files say for this model, if they can; files of ours write its name otherwise.
    std::optional<GltfSurface> gltf = std::nullopt;

    /// Fits know the derivatives of elements whose answer does not depend on directions.
    constexpr bool can_be_fitted() const { return element && !element->glossy; }
};

}  // namespace renderer
