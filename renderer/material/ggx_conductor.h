// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/material/ggx.h"
#include "renderer/material/surface_traits.h"

#include <algorithm>
#include <cmath>

namespace renderer {

/// Rough conductor: GGX normals, height-correlated Smith shadowing, Schlick's Fresnel term with the
/// albedo at normal incidence (source [Walter2007], [Heitz2014], [Schlick1994]).
struct GgxConductor {
    double albedo = 1.0;
    double alpha = 1.0;  ///< GGX width, the square of glTF's roughness

    static constexpr SurfaceTraits kTraits{.name = "ggx conductor",
                                           .has_lobe = true,
                                           .reflects_when_black = true,
                                           .element = ElementResponse{.glossy = true},
                                           .gltf = GltfSurface{.metallic = true}};

    double evaluate(const core::Vec3& incoming, const core::Vec3& outgoing) const {
        const core::Vec3 half = (incoming + outgoing).normalized();
        return ggx_value(
            albedo, alpha, normal_density(half), incoming.z(), outgoing.z(), half.dot(incoming));
    }

    // The density of visible normals is D max(0, i.h) / ((1 + Lambda(i)) i_z), and reflection about
    // h divides it by 4 i.h.
    double pdf(const core::Vec3& incoming, const core::Vec3& outgoing) const {
        const core::Vec3 half = (incoming + outgoing).normalized();
        return normal_density(half) / (2.0 * (incoming.z() + ggx_masking(alpha, incoming.z())));
    }

    // Source [Heitz2018].
    std::optional<core::Vec3> sample(const core::Vec3& incoming, const core::Vec2& u) const {
        using core::Vec3;
        // Stretch the surface so that its microfacets form a hemisphere, draw a point of the
        // visible half disk about the view direction, and shrink the normal found there.
        const Vec3 view =
            Vec3(alpha * incoming.x(), alpha * incoming.y(), incoming.z()).normalized();
        const double radius = std::sqrt(u.x());
        const double angle = 2.0 * core::kPi * u.y();
        // The half disk is squeezed along `upward`, in which the surface is foreshortened.
        const Vec3 across = std::abs(view.z()) < 1.0 - 1e-12
                                ? Vec3(Vec3::UnitZ().cross(view).normalized())
                                : Vec3(Vec3::UnitX());
        const Vec3 upward = view.cross(across);
        const double t1 = radius * std::cos(angle);
        const double squeeze = 0.5 * (1.0 + view.z());
        const double t2 = (1.0 - squeeze) * std::sqrt(std::max(0.0, 1.0 - t1 * t1)) +
                          squeeze * radius * std::sin(angle);
        const double t3 = std::sqrt(std::max(0.0, 1.0 - t1 * t1 - t2 * t2));
        const Vec3 stretched = t1 * across + t2 * upward + t3 * view;
        const Vec3 half =
            Vec3(alpha * stretched.x(), alpha * stretched.y(), std::max(1e-12, stretched.z()))
                .normalized();
        const Vec3 outgoing = 2.0 * incoming.dot(half) * half - incoming;
        if (!(outgoing.z() > 0.0)) return std::nullopt;
        return outgoing;
    }

    // Shadowed visible normals reflect at most all, each by Schlick's term, which falls with the
    // cosine between a direction and the half vector. That is |i + o| / 2, at least (i_z + o_z) / 2
    // and so at least half the cosine of i.
    double reflects_at_most(double cosine) const {
        return albedo + (1.0 - albedo) * std::pow(1.0 - 0.5 * cosine, 5);
    }

    double lobe_fraction(double) const { return 1.0; }

 private:
    double normal_density(const core::Vec3& half) const {
        return ggx_normal_density(alpha, half.z() * half.z(), half.head<2>().squaredNorm());
    }
};

}  // namespace renderer
