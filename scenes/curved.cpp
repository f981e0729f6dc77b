// SPDX-License-Identifier: MIT
#include "scenes/generated_scenes.h"
#include "scenes/shapes.h"
#include <fmt/core.h>

#include <cmath>

namespace scenes {
namespace {

using core::Vec3;

constexpr int kStrips = 32;  ///< flat strips of the wall, each with one column of sensing points
constexpr int kRows = 32;
constexpr double kWallRadius_m = 1.2;
constexpr double kWallSize_m = 1.0;

/// A cylinder patch around a vertical axis, hollow side towards the hidden scene (+z).
core::TriangleMesh make_wall() {
    const double half_angle = std::asin(kWallSize_m / 2.0 / kWallRadius_m);
    core::TriangleMesh mesh;
    for (int i = 0; i <= kStrips; ++i) {
        const double angle = half_angle * (2.0 * i / kStrips - 1.0);
        for (const double y : {-kWallSize_m / 2.0, kWallSize_m / 2.0}) {
            mesh.vertices.emplace_back(
                kWallRadius_m * std::sin(angle), y, kWallRadius_m * (1.0 - std::cos(angle)));
        }
    }
    for (std::uint32_t i = 0; i < kStrips; ++i) {
        const std::uint32_t v = 2 * i;  // lower left; v + 1 above it, v + 2 to its side
        mesh.triangles.push_back({v, v + 2, v + 3});
        mesh.triangles.push_back({v, v + 3, v + 1});
    }
    return mesh;
}

struct WallPoint {
    Vec3 position;
    Vec3 normal;
};

/// Cell centres of a strips-by-rows grid, x first, each exactly on its facet.
std::vector<WallPoint> sensing_points(const core::TriangleMesh& wall) {
    std::vector<WallPoint> points;
    for (std::size_t strip = 0; strip < kStrips; ++strip) {
        for (int row = 0; row < kRows; ++row) {
            // In the strip's unit square u = 1/2; the diagonal u = v separates its two triangles.
            const double u = 0.5;
            const double v = (row + 0.5) / kRows;
            const auto& [a, b, c] = wall.triangles[2 * strip + (v < u ? 0 : 1)];
            const Vec3& p = wall.vertices[a];
            const Vec3 ab = wall.vertices[b] - p;
            const Vec3 ac = wall.vertices[c] - p;
            const Vec3 offset = v < u ? Vec3((u - v) * ab + v * ac) : Vec3(u * ab + (v - u) * ac);
            points.push_back({p + offset, ab.cross(ac).normalized()});
        }
    }
    return points;
}

std::string list_text(const std::vector<WallPoint>& points, Vec3 WallPoint::*member) {
    std::string text;
    for (const WallPoint& point : points) {
        const Vec3& v = point.*member;
        text += fmt::format("{}      [{}, {}, {}]", text.empty() ? "" : ",\n", v.x(), v.y(), v.z());
    }
    return text;
}

std::string describe(const std::vector<WallPoint>& points) {
    return fmt::format(
        "{{\n"
        "  \"geometry\": \"scene.glb\",\n"
        "  \"scan\": {{\n"
        "    \"pattern\": \"confocal\",\n"
        "    \"sensing_points_m\": [\n{}\n    ],\n"
        "    \"sensing_normals\": [\n{}\n    ]\n"
        "  }},\n"
        "  \"time_axis\": {{ \"opl_start_m\": 0.0, \"bin_width_m\": 0.008, \"num_bins\": 512 }},\n"
        "  \"render\": {{ \"method\": \"auto\", \"max_bounces\": 3, \"samples\": 512 }}\n"
        "}}\n",
        list_text(points, &WallPoint::position),
        list_text(points, &WallPoint::normal));
}

}  // namespace

GeneratedScene make_curved() {
    GeneratedScene scene{"curved", {}, {}};
    renderer::Object& wall = scene.add("wall", make_wall(), {0.0, 0.0, 0.0}, diffuse(1.0));
    wall.role = renderer::Role::RelayWall;
    scene.description = describe(sensing_points(wall.mesh));
    scene.add("ring",
              rotated(make_torus(0.16, 0.06, 64, 28), Vec3::UnitX(), 25.0),
              {0.05, 0.03, 0.75},
              diffuse(0.8));
    return scene;
}

}  // namespace scenes
