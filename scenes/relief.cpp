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

core::TriangleMesh make_plane(const core::Vec3& corner, const core::Vec3& u, const core::Vec3& v) {
    const core::Vec3 far = corner + u + v;
    return make_quad(corner, corner + u, far, corner + v);
}

}  // namespace

GeneratedScene make_relief_room() {
    GeneratedScene scene{"relief", {}, {}};
    const core::Vec3 deep(0.0, 0.0, -kDepth);
    const core::Vec3 up(0.0, 2.0 * kHalf, 0.0);
    const core::Vec3 right(kHalf, 0.0, 0.0);
    const auto add = [&](const std::string& name, core::TriangleMesh mesh) {
        scene.add(name, std::move(mesh), {0.0, 0.0, 0.0}, diffuse(0.7));
    };
    const core::Vec3 left_bottom(-kHalf, -kHalf, 0.0);
    const core::Vec3 middle_bottom(0.0, -kHalf, 0.0);
    const core::Vec3 right_bottom(kHalf, -kHalf, 0.0);
    add("left_wall", make_relief(left_bottom, deep, up));
    add("left_floor", make_relief(left_bottom, right, deep));
    add("right_floor", make_plane(middle_bottom, right, deep));
    add("right_wall", make_plane(right_bottom, up, deep));
    add("ceiling", make_plane(left_bottom + up, 2.0 * right, deep));
    add("left_back", make_relief(left_bottom + deep, right, up));
    add("right_back", make_plane(middle_bottom + deep, right, up));
    return scene;
}

}  // namespace scenes
