// SPDX-License-Identifier: MIT
#include "scenes/generated_scenes.h"
#include "scenes/shapes.h"

#include <cmath>

namespace scenes {
namespace {

constexpr double kHalf = 0.5;
constexpr double kDepth = 1.2;
constexpr double kFacet_m = 0.025;
constexpr double kHeight_m = 0.012;  ///< of the waves, either way

// A rectangle corner + [0, 1] u + [0, 1] v in small facets, wavy along its normal but for its rim.
core::TriangleMesh make_relief(const core::Vec3& corner, const core::Vec3& u, const core::Vec3& v) {
    const int nu = static_cast<int>(std::lround(u.norm() / kFacet_m));
    const int nv = static_cast<int>(std::lround(v.norm() / kFacet_m));
    const core::Vec3 normal = u.cross(v).normalized();
    core::TriangleMesh mesh;
    for (int i = 0; i <= nu; ++i) {
        for (int j = 0; j <= nv; ++j) {
            const double s = static_cast<double>(i) / nu;
            const double t = static_cast<double>(j) / nv;
            const bool is_rim = i == 0 || j == 0 || i == nu || j == nv;
            const double wave = std::sin(40.0 * s * u.norm()) * std::sin(37.0 * t * v.norm() + 1.0);
            mesh.vertices.push_back(corner + s * u + t * v +
                                    (is_rim ? 0.0 : kHeight_m * wave) * normal);
        }
    }
    const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i * (nv + 1) + j); };
    for (int i = 0; i < nu; ++i) {
        for (int j = 0; j < nv; ++j) {
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    return mesh;
}

}  // namespace

GeneratedScene make_relief_room() {
    GeneratedScene scene{"relief", {}, {}};
    auto& objects = scene.geometry.objects;
    const core::Vec3 origin(0.0, 0.0, 0.0);
    const core::Vec3 deep(0.0, 0.0, -kDepth);
    const core::Vec3 up(0.0, 2.0 * kHalf, 0.0);
    const core::Vec3 right(kHalf, 0.0, 0.0);
    const auto add_plane = [&](const std::string& name,
                               const core::Vec3& corner,
                               const core::Vec3& u,
                               const core::Vec3& v) {
        const core::Vec3 far = corner + u + v;
        objects.push_back(
            place(name, make_quad(corner, corner + u, far, corner + v), origin, diffuse(0.7)));
    };
    const auto add_relief = [&](const std::string& name,
                                const core::Vec3& corner,
                                const core::Vec3& u,
                                const core::Vec3& v) {
        objects.push_back(place(name, make_relief(corner, u, v), origin, diffuse(0.7)));
    };
    const core::Vec3 left_bottom(-kHalf, -kHalf, 0.0);
    const core::Vec3 middle_bottom(0.0, -kHalf, 0.0);
    const core::Vec3 right_bottom(kHalf, -kHalf, 0.0);
    add_relief("left_wall", left_bottom, deep, up);
    add_relief("left_floor", left_bottom, right, deep);
    add_plane("right_floor", middle_bottom, right, deep);
    add_plane("right_wall", right_bottom, up, deep);
    add_plane("ceiling", left_bottom + up, 2.0 * right, deep);
    add_relief("left_back", left_bottom + deep, right, up);
    add_plane("right_back", middle_bottom + deep, right, up);
    return scene;
}

}  // namespace scenes
