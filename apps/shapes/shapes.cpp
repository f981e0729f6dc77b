// SPDX-License-Identifier: MIT
#include "apps/shapes/shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

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

namespace {

/// A surface of revolution about y; `profile` gives radius and height for v from -1 (below) to 1.
template <class Profile>
core::TriangleMesh revolve(int cells, const Profile& profile) {
    return make_grid_mesh(cells, [&](double u, double v) {
        const double angle = std::numbers::pi * u;
        const auto [radius, height] = profile(v);
        return Vec3(radius * std::cos(angle), height, radius * std::sin(angle));
    });
}

struct RadiusAndHeight {
    double radius;
    double height;
};

/// The lowest and the highest quarter are the lids.
RadiusAndHeight cylinder_profile(double v) {
    constexpr double kRadius = 0.6;
    const double radius = std::abs(v) > 0.5 ? 2.0 * kRadius * (1.0 - std::abs(v)) : kRadius;
    return {radius, std::clamp(2.0 * v, -1.0, 1.0)};
}

RadiusAndHeight cone_profile(double v) {
    constexpr double kRadius = 0.8;
    return v < -0.5 ? RadiusAndHeight{2.0 * kRadius * (v + 1.0), -1.0}
                    : RadiusAndHeight{kRadius * (1.0 - v) / 1.5, -1.0 + 2.0 * (v + 0.5) / 1.5};
}

core::TriangleMesh make_torus(int cells) {
    constexpr double kRing = 0.7;
    constexpr double kTube = 0.3;
    return make_grid_mesh(cells, [&](double u, double v) {
        const double along = std::numbers::pi * u;
        const double around = std::numbers::pi * v;
        const double radius = kRing + kTube * std::cos(around);
        return Vec3(radius * std::cos(along), radius * std::sin(along), kTube * std::sin(around));
    });
}

/// Six faces, each a grid.
core::TriangleMesh make_box(int cells) {
    constexpr double kDepthOverWidth = 0.6;
    core::TriangleMesh mesh;
    for (const int axis : {0, 1, 2}) {
        for (const double side : {-1.0, 1.0}) {
            const int next = (axis + 1) % 3;
            core::append_mesh(make_grid_mesh(std::max(2, cells / 3),
                                             [&](double u, double v) {
                                                 Vec3 point;
                                                 point[axis] = side;
                                                 point[next] =
                                                     side * u;  // so that all faces look outwards
                                                 point[3 - axis - next] = v;
                                                 point.z() *= kDepthOverWidth;
                                                 return point;
                                             }),
                              mesh);
        }
    }
    return mesh;
}

core::TriangleMesh make_blob(int cells) {
    core::TriangleMesh mesh = make_sphere_mesh(Vec3::Zero(), 1.0, cells);
    for (Vec3& p : mesh.vertices) {
        const double bumps = std::sin(3.0 * p.x() + 1.0) * std::sin(4.0 * p.y() + 2.0) +
                             0.6 * std::sin(5.0 * p.z() + 3.0 * p.x());
        p *= 0.8 + 0.2 * bumps;
    }
    return mesh;
}

/// Poles of a grid that is bent into a closed surface leave triangles that are lines.
core::TriangleMesh without_empty_triangles(core::TriangleMesh mesh) {
    std::erase_if(mesh.triangles, [&](const auto& triangle) {
        const Vec3& corner = mesh.vertices[triangle[0]];
        return !core::has_area(mesh.vertices[triangle[1]] - corner,
                               mesh.vertices[triangle[2]] - corner);
    });
    return mesh;
}

core::TriangleMesh grid_of(BasicShape shape, int cells) {
    switch (shape) {
        case BasicShape::Sphere:
            return make_sphere_mesh(Vec3::Zero(), 1.0, cells);
        case BasicShape::Box:
            return make_box(cells);
        case BasicShape::Plate:
            return make_grid_mesh(cells, [](double u, double v) { return Vec3(u, v, 0.0); });
        case BasicShape::Cylinder:
            return revolve(cells, cylinder_profile);
        case BasicShape::Cone:
            return revolve(cells, cone_profile);
        case BasicShape::Torus:
            return make_torus(cells);
        case BasicShape::Blob:
            return make_blob(cells);
    }
    return {};
}

}  // namespace

core::TriangleMesh make_shape(BasicShape shape, int cells) {
    return without_empty_triangles(grid_of(shape, cells));
}

}  // namespace apps
