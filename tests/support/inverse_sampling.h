// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/sampling.h"
#include "renderer/geometry/ellipsoid.h"

namespace test_support {

// Inverses of the samplers, which only tests need.

/// The u that core::sample_triangle maps to `barycentric`.
inline core::Vec2 invert_triangle(const core::Vec2& barycentric) {
    const double root = barycentric.sum();
    return {root * root, root > 0.0 ? barycentric.y() / root : 0.0};
}

inline double azimuth_fraction(const core::Vec3& direction) {
    const double fraction = std::atan2(direction.y(), direction.x()) / (2.0 * core::kPi);
    return std::min(fraction < 0.0 ? fraction + 1.0 : fraction, core::kBelowOne);
}

/// The u that core::sample_cosine_hemisphere maps to `direction`.
inline core::Vec2 invert_cosine_hemisphere(const core::Vec3& direction) {
    return {direction.head<2>().squaredNorm(), azimuth_fraction(direction)};
}

/// The u that core::sample_sphere maps to `direction`.
inline core::Vec2 invert_sphere(const core::Vec3& direction) {
    return {0.5 * (1.0 - direction.z()), azimuth_fraction(direction)};
}

/// The u for which sample_ellipsoid() at the length of `x` gives `x`, without a lobe; nothing where
/// it cannot.
inline std::optional<double> invert_ellipsoid(const renderer::FocusPair& foci,
                                              const renderer::Facet& facet,
                                              const core::Vec3& x) {
    const auto section = renderer::EllipsoidSection::cut(foci, foci.opl_m(x), facet);
    if (!section) return std::nullopt;
    const renderer::EllipsoidArcs arcs(*section, facet);
    if (!(arcs.total_rad() > 0.0)) return std::nullopt;
    return arcs.invert(section->angle_of(x));
}

}  // namespace test_support
