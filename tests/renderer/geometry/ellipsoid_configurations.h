// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/random.h"
#include "renderer/geometry/ellipsoid.h"
#include "tests/support/random_geometry.h"
#include "tests/support/statistics.h"

#include <cmath>
#include <optional>
#include <string>
#include <vector>

namespace ellipsoid_test {

/// Foci, a triangle and an interval of lengths.
struct Configuration {
    std::string name;
    renderer::FocusPair foci;
    renderer::Facet facet;
    renderer::OplBand lengths;
};

/// The interval between two fractions of the facet's band.
inline renderer::OplBand part_of_band(const renderer::FocusPair& foci,
                                      const renderer::Facet& facet,
                                      double from,
                                      double to) {
    const renderer::OplBand band = opl_band(foci, facet);
    return {band.low_m + from * band.width_m(), band.low_m + to * band.width_m()};
}

inline Configuration make(const std::string& name,
                          const renderer::FocusPair& foci,
                          const renderer::Facet& facet) {
    return {name, foci, facet, part_of_band(foci, facet, 0.0, 1.0)};
}

inline renderer::Facet facet_of(const core::Vec3& a, const core::Vec3& b, const core::Vec3& c) {
    return test_support::make_facet(a, b, c);
}

inline std::vector<Configuration> configurations(const std::string& test) {
    core::Rng rng(test_support::seed_of(test), 0, 0);
    const auto point = [&] { return test_support::random_point(rng); };
    const auto facet = [&] { return facet_of(point(), point(), point()); };
    std::vector<Configuration> all;
    for (int i = 0; i < 8; ++i) {
        const renderer::FocusPair foci{point(), point()};
        const renderer::Facet random = facet();
        all.push_back(make("random", foci, random));
        all.push_back({"narrow", foci, random, part_of_band(foci, random, 0.4, 0.45)});
        const core::Vec3 a = point();
        all.push_back(make("coincident", {a, a}, random));
        const double apart = std::pow(10.0, -3.0 - 1.5 * i);
        all.push_back(make("near coincident", {a, a + apart * core::Vec3(0.3, -0.5, 0.8)}, random));
        // The shortest length of a triangle around the foot of the foci: a tangent plane.
        const renderer::Facet under = facet_of(a + core::Vec3(-1.0, -0.8, -0.5),
                                               a + core::Vec3(1.2, -0.7, -0.5),
                                               a + core::Vec3(0.1, 1.1, -0.5));
        all.push_back({"tangent",
                       {a, a + core::Vec3(0.2, 0.1, 0.0)},
                       under,
                       part_of_band({a, a + core::Vec3(0.2, 0.1, 0.0)}, under, 0.0, 0.05)});
        // A triangle across the segment between the foci: lengths down to their distance.
        const core::Vec3 middle = 0.5 * (foci.a + foci.b);
        const core::Vec3 arm1 = 0.4 * point();
        const core::Vec3 arm2 = 0.4 * point();
        const double distance = (foci.a - foci.b).norm();
        all.push_back({"at the foci's distance",
                       foci,
                       facet_of(middle + arm1, middle + arm2, middle - arm1 - arm2),
                       {distance, distance * (1.0 + std::pow(10.0, -1.0 - 0.15 * i))}});
        const core::Vec3 corner = point();
        const core::Vec3 along = point() - corner;
        all.push_back(
            make("sliver",
                 foci,
                 facet_of(corner,
                          corner + along,
                          corner + 0.4 * along + std::pow(10.0, -1.0 - 0.5 * i) * point())));
        // A plane that holds both foci.
        all.push_back(
            make("in the plane", {random.point(0.2, 0.9), random.point(-0.4, 0.3)}, random));
    }
    return all;
}

/// A sample of a random length, with the random number it came from.
struct Draw {
    double opl_m = 0.0;
    double u = 0.0;
    renderer::EllipsoidalConnection connection;
};

inline std::optional<Draw> draw_from(const Configuration& c, core::Rng& rng) {
    Draw draw;
    draw.opl_m = c.lengths.low_m + rng.uniform() * c.lengths.width_m();
    draw.u = rng.uniform();
    const auto connection = sample_ellipsoid(c.foci, draw.opl_m, c.facet, draw.u);
    if (!connection) return std::nullopt;
    draw.connection = *connection;
    return draw;
}

}  // namespace ellipsoid_test
