// SPDX-License-Identifier: MIT
#include "tests/support/shift_cases.h"

#include "renderer/core/sampling.h"
#include "tests/support/test_scenes.h"

#include <array>
#include <cmath>

namespace test_support {

using core::Vec2;
using core::Vec3;

Vec3 random_direction(core::Rng& rng) {
    const double u = rng.uniform();
    return core::sample_sphere({u, rng.uniform()});
}

ShiftCase random_shift_case(const renderer::Scene& scene,
                            const Vec3& centre,
                            const ShiftCaseSettings& settings,
                            core::Rng& rng) {
    const auto on_wall = [&] {
        const double x = rng.uniform() - 0.5;
        return Vec3(centre + settings.scale_m * Vec3(x, rng.uniform() - 0.5, 0.0));
    };
    const auto moved = [&](const Vec3& p) {
        return Vec3(p + settings.moved_m * random_direction(rng));
    };
    ShiftCase c;
    c.x.facet = static_cast<std::uint32_t>(rng.uniform() * double(scene.facets().size()));
    const Vec2 b = core::sample_triangle({rng.uniform(), rng.uniform()});
    c.x.position = scene.facet(c.x.facet).point(b.x(), b.y());
    c.source.a = on_wall();
    c.source.y = settings.confocal ? c.source.a : on_wall();
    c.target.a = moved(c.source.a);
    c.target.y = settings.confocal ? c.target.a : moved(c.source.y);
    c.source.normal_y = c.target.normal_y = Vec3::UnitZ();
    for (renderer::ShiftEnd* end : {&c.source, &c.target}) {
        end->velocity_a = settings.velocity_m_per_s * random_direction(rng);
        end->velocity_y = settings.velocity_m_per_s * random_direction(rng);
    }
    const double length = (c.source.a - c.x.position).norm() + (c.source.y - c.x.position).norm();
    c.change.ratio = settings.ratio;
    c.change.offset_m =
        (1.0 - settings.ratio) * length + settings.offset_m * (2.0 * rng.uniform() - 1.0);
    return c;
}

renderer::Scene scene_of(std::vector<renderer::Object> objects, const Vec3& centre) {
    // A wall that does not carry the scan's points is not added.
    renderer::RelayWall elsewhere;
    elsewhere.center_m = centre + Vec3(0.0, 0.0, -10.0);
    return {{std::move(objects), {}}, confocal_scan({centre}), elsewhere};
}

renderer::Object tilted_quad(const Vec3& centre, double scale_m) {
    const Vec3 u = scale_m * Vec3(3.0, 0.4, 0.5);
    const Vec3 v = scale_m * Vec3(-0.3, 3.0, 0.3);
    const Vec3 middle = centre + scale_m * Vec3(0.0, 0.0, 1.2);
    return parallelogram_object({middle - 0.5 * (u + v), u, v});
}

renderer::Object wavy_sheet(const Vec3& centre, double scale_m, int cells, double height_m) {
    renderer::Object object;
    for (int j = 0; j <= cells; ++j) {
        for (int i = 0; i <= cells; ++i) {
            const double x = 2.0 * i / cells - 1.0;
            const double y = 2.0 * j / cells - 1.0;
            const double z = 1.0 + height_m / scale_m * std::sin(5.0 * x + 1.0) * std::cos(4.0 * y);
            object.mesh.vertices.push_back(centre + scale_m * Vec3(x, y, z));
        }
    }
    const auto index = [&](int i, int j) {
        return static_cast<std::uint32_t>(j * (cells + 1) + i);
    };
    for (int j = 0; j < cells; ++j) {
        for (int i = 0; i < cells; ++i) {
            object.mesh.triangles.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
            object.mesh.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
        }
    }
    return object;
}

std::optional<double> jacobian_by_differences(const renderer::Scene& scene,
                                              const renderer::ShiftMapping& mapping,
                                              const ShiftCase& c,
                                              double step_m) {
    renderer::ShiftCounts counts;
    const auto landing = shift(mapping, c, counts);
    if (!landing) return std::nullopt;
    const core::Mat3 frame = scene.facet(c.x.facet).world_from_facet();
    const core::Mat3 image_frame = scene.facet(landing->point.facet).world_from_facet();
    Eigen::Matrix2d derivative;
    for (int axis = 0; axis < 2; ++axis) {
        const auto at = [&](double steps) -> std::optional<Vec2> {
            ShiftCase near = c;
            near.x.position += steps * step_m * frame.col(axis);
            const auto result = shift(mapping, near, counts);
            if (!result) return std::nullopt;
            const Vec3 local =
                image_frame.transpose() * (result->point.position - landing->point.position);
            // On another plane the map has a kink.
            if (std::abs(local.z()) > 1e-9 * step_m + 1e-12) return std::nullopt;
            return Vec2(local.x(), local.y());
        };
        const auto plus1 = at(1.0);
        const auto minus1 = at(-1.0);
        const auto plus2 = at(2.0);
        const auto minus2 = at(-2.0);
        if (!plus1 || !minus1 || !plus2 || !minus2) return std::nullopt;
        derivative.col(axis) = (8.0 * (*plus1 - *minus1) - (*plus2 - *minus2)) / (12.0 * step_m);
    }
    return std::abs(derivative.determinant());
}

}  // namespace test_support
