// SPDX-License-Identifier: MIT
#include "apps/shapes/grid_mesh.h"

#include <cmath>

namespace apps {

using core::Vec3;

core::TriangleMesh make_grid_mesh(int cells,
                                  const std::function<Vec3(double u, double v)>& position) {
    core::TriangleMesh mesh;
    for (int j = 0; j <= cells; ++j) {
        for (int i = 0; i <= cells; ++i) {
            mesh.vertices.push_back(position(2.0 * i / cells - 1.0, 2.0 * j / cells - 1.0));
        }
    }
    const auto index = [&](int i, int j) {
        return static_cast<std::uint32_t>(j * (cells + 1) + i);
    };
    for (int j = 0; j < cells; ++j) {
        for (int i = 0; i < cells; ++i) {
            const std::uint32_t a = index(i, j);
            const std::uint32_t b = index(i + 1, j);
            const std::uint32_t c = index(i + 1, j + 1);
            const std::uint32_t d = index(i, j + 1);
            if ((2 * i + 1 < cells) == (2 * j + 1 < cells)) {
                mesh.triangles.push_back({a, d, b});
                mesh.triangles.push_back({b, d, c});
            } else {
                mesh.triangles.push_back({a, c, b});
                mesh.triangles.push_back({a, d, c});
            }
        }
    }
    return mesh;
}

core::TriangleMesh make_sphere_mesh(const Vec3& center, double radius_m, int cells) {
    return make_grid_mesh(cells, [&](double u, double v) {
        // Corners of the square beyond |u| + |v| = 1 are folded over to the lower half.
        const double z = 1.0 - std::abs(u) - std::abs(v);
        const double x = z < 0.0 ? std::copysign(1.0 - std::abs(v), u) : u;
        const double y = z < 0.0 ? std::copysign(1.0 - std::abs(u), v) : v;
        return Vec3(center + radius_m * Vec3(x, y, z).normalized());
    });
}

}  // namespace apps
