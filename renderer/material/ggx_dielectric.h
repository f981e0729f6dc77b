// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/material/ggx_conductor.h"
#include "renderer/material/lambertian.h"

namespace renderer {

/// Rough dielectric: GGX reflection at an interface of index 1.5, 0.04 at normal incidence, over a
/// diffuse body that gets what the interface lets in and out. Source [glTF2], appendix B, but for
/// the body's fraction: there it depends on the half vector, and grazing light comes back as more
/// than all.
struct GgxDielectric {
    double albedo = 1.0;  ///< of the body
    double alpha = 1.0;   ///< GGX width

    static constexpr SurfaceTraits kTraits{.name = "ggx dielectric",
                                           .has_lobe = true,
                                           .reflects_when_black = true,
                                           .gltf = GltfSurface{.specular = true}};

    double evaluate(const core::Vec3& incoming, const core::Vec3& outgoing) const {
        const double let_through = (1.0 - fresnel(incoming.z())) * (1.0 - fresnel(outgoing.z()));
        return let_through * albedo / core::kPi + interface().evaluate(incoming, outgoing);
    }

    double pdf(const core::Vec3& incoming, const core::Vec3& outgoing) const {
        const double of_interface = lobe_fraction(incoming.z());
        return of_interface * interface().pdf(incoming, outgoing) +
               (1.0 - of_interface) * Lambertian{}.pdf(incoming, outgoing);
    }

    std::optional<core::Vec3> sample(const core::Vec3& incoming, const core::Vec2& u) const {
        const double of_interface = lobe_fraction(incoming.z());
        if (u.x() < of_interface) {
            return interface().sample(incoming, {u.x() / of_interface, u.y()});
        }
        return Lambertian{}.sample(incoming,
                                   {(u.x() - of_interface) / (1.0 - of_interface), u.y()});
    }

    // What the interface reflects, and of what it lets in the part that the body returns through
    // it: the mean of 1 - fresnel over outgoing cosines, (1 - 0.04) (1 - 2/42). No more than all,
    // which is measured: at every incidence the interface shadows more than Schlick's term at the
    // half vectors exceeds that at the normal.
    double reflects_at_most(double cosine) const {
        constexpr double kLetOut = (1.0 - kNormalReflectance) * 20.0 / 21.0;
        return std::min(
            1.0, interface().reflects_at_most(cosine) + (1.0 - fresnel(cosine)) * kLetOut * albedo);
    }

    double lobe_fraction(double cosine) const {
        const double reflected = fresnel(cosine);
        return std::clamp(reflected / (reflected + (1.0 - reflected) * albedo), 0.1, 0.9);
    }

 private:
    static constexpr double kNormalReflectance = 0.04;  // at normal incidence, index 1.5

    GgxConductor interface() const { return {kNormalReflectance, alpha}; }

    // Reflected fraction at an angle of this cosine, by Schlick's approximation.
    static double fresnel(double cosine) {
        return kNormalReflectance + (1.0 - kNormalReflectance) * std::pow(1.0 - cosine, 5);
    }
};

}  // namespace renderer
