// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/geometry/ellipsoid.h"
#include "tests/support/random_geometry.h"

#include <cmath>

namespace test_support {

/// What random configurations of every size and degeneracy did.
struct StressCounts {
    std::uint64_t drawn = 0;
    std::uint64_t bad = 0;  ///< not finite, density not positive, or wrong length
};

/// Draws `count` ellipsoidal connections, each with new foci and triangle: sizes from 1 mm to
/// 100 m, foci from coincident to far apart, lengths down to the distance of the foci, slivers,
/// tangent planes, planes that hold a focus; a third of them towards a lobe.
inline StressCounts stress_ellipsoid(std::uint64_t count, std::uint64_t seed) {
    core::Rng rng(seed, 0, 0);
    StressCounts counts;
    const auto power = [&](double from, double to) { return power_of_ten(rng, from, to); };
    for (std::uint64_t i = 0; i < count; ++i) {
        const double size = power(-3.0, 2.0);
        renderer::FocusPair foci{size * random_point(rng), core::Vec3::Zero()};
        const double kind = rng.uniform();
        foci.b =
            kind < 0.2 ? foci.a : core::Vec3(foci.a + size * power(-16.0, 0.3) * random_point(rng));
        const core::Vec3 corner =
            rng.uniform() < 0.1 ? foci.a : core::Vec3(size * random_point(rng));
        const core::Vec3 along = size * power(-4.0, 0.5) * random_point(rng);
        const core::Vec3 across =
            rng.uniform() < 0.2
                ? core::Vec3(rng.uniform() * along + power(-9.0, -2.0) * size * random_point(rng))
                : core::Vec3(size * power(-4.0, 0.5) * random_point(rng));
        const renderer::Facet facet = make_facet(corner, corner + along, corner + across);
        if (!(facet.area_m2 > 0.0)) continue;
        const renderer::OplBand band = opl_band(foci, facet);
        const double fraction = rng.uniform() < 0.3 ? power(-15.0, -1.0) : rng.uniform();
        const double opl_m = band.low_m + fraction * band.width_m();
        renderer::ConnectionLobe lobe;
        lobe.point = facet.point(3.0 * rng.uniform() - 1.0, 3.0 * rng.uniform() - 1.0);
        if (rng.uniform() < 0.1) lobe.point = foci.a;
        lobe.direction = (lobe.point - foci.a).normalized();
        lobe.width_rad = power(-3.0, 0.0);
        const renderer::ConnectionLobe* const aim = rng.uniform() < 1.0 / 3.0 ? &lobe : nullptr;
        const auto connection = sample_ellipsoid(foci, opl_m, facet, rng.uniform(), aim);
        if (!connection) continue;
        ++counts.drawn;
        const double pdf = connection->pdf_area_per_pdf_opl;
        const double again = pdf_ellipsoid(foci, facet, connection->position, aim);
        const double error = std::abs(foci.opl_m(connection->position) - opl_m);
        const bool good = connection->position.allFinite() && std::isfinite(pdf) && pdf > 0.0 &&
                          std::isfinite(again) && again >= 0.0 &&
                          error <= 1e-12 * std::max(opl_m, size);
        if (!good) ++counts.bad;
    }
    return counts;
}

}  // namespace test_support
