// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/random.h"
#include "renderer/scene/scene.h"

#include <cmath>

namespace test_support {

/// A point uniform in the cube [-1, 1]^3.
inline core::Vec3 random_point(core::Rng& rng) {
    const double x = 2.0 * rng.uniform() - 1.0;
    const double y = 2.0 * rng.uniform() - 1.0;
    return {x, y, 2.0 * rng.uniform() - 1.0};
}

/// 10^x with x uniform between two exponents.
inline double power_of_ten(core::Rng& rng, double from, double to) {
    return std::pow(10.0, from + (to - from) * rng.uniform());
}

/// A facet that belongs to no scene.
inline renderer::Facet make_facet(const core::Vec3& a, const core::Vec3& b, const core::Vec3& c) {
    renderer::Facet facet;
    facet.corner = a;
    facet.edge1 = b - a;
    facet.edge2 = c - a;
    const core::Vec3 area_vector = 0.5 * facet.edge1.cross(facet.edge2);
    facet.area_m2 = area_vector.norm();
    facet.normal = area_vector / facet.area_m2;
    return facet;
}

}  // namespace test_support
