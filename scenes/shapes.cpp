// SPDX-License-Identifier: MIT
#include "scenes/shapes.h"

#include <cmath>
#include <map>
#include <utility>

namespace scenes {
namespace {

using core::TriangleMesh;
using core::Vec3;

TriangleMesh make_icosahedron() {
    const double p = (1.0 + std::sqrt(5.0)) / 2.0;
    TriangleMesh mesh;
    mesh.vertices = {{-1, p, 0},
                     {1, p, 0},
                     {-1, -p, 0},
                     {1, -p, 0},
                     {0, -1, p},
                     {0, 1, p},
                     {0, -1, -p},
                     {0, 1, -p},
                     {p, 0, -1},
                     {p, 0, 1},
                     {-p, 0, -1},
                     {-p, 0, 1}};
    mesh.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                      {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                      {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                      {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    for (Vec3& vertex : mesh.vertices) vertex.normalize();
    return mesh;
}

/// Splits every triangle of a unit sphere into four; neighbours share the new vertices.
TriangleMesh subdivide(TriangleMesh mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> midpoints;
    const auto midpoint = [&](std::uint32_t a, std::uint32_t b) {
        const auto [it, is_new] = midpoints.try_emplace(
            std::minmax(a, b), static_cast<std::uint32_t>(mesh.vertices.size()));
        if (is_new) mesh.vertices.push_back((mesh.vertices[a] + mesh.vertices[b]).normalized());
        return it->second;
    };
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (const auto& [a, b, c] : mesh.triangles) {
        const std::uint32_t ab = midpoint(a, b);
        const std::uint32_t bc = midpoint(b, c);
        const std::uint32_t ca = midpoint(c, a);
        triangles.insert(triangles.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    mesh.triangles = std::move(triangles);
    return mesh;
}

double as_stored(double x) {
    constexpr double kGrid = 1e7;  // steps per metre
    return static_cast<double>(static_cast<float>(std::round(x * kGrid) / kGrid));
}

}  // namespace

TriangleMesh make_box(const Vec3& size_m) {
    TriangleMesh mesh;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 side(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5, corner & 4 ? 0.5 : -0.5);
        mesh.vertices.push_back(side.cwiseProduct(size_m));
    }
    mesh.triangles = {{0, 2, 3},
                      {0, 3, 1},
                      {4, 5, 7},
                      {4, 7, 6},
                      {0, 1, 5},
                      {0, 5, 4},
                      {2, 6, 7},
                      {2, 7, 3},
                      {0, 4, 6},
                      {0, 6, 2},
                      {1, 3, 7},
                      {1, 7, 5}};
    return mesh;
}

TriangleMesh make_quad(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    TriangleMesh mesh;
    mesh.vertices = {a, b, c, d};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return mesh;
}

TriangleMesh make_radial_surface(int subdivisions,
                                 const std::function<double(const Vec3&)>& radius_m) {
    TriangleMesh mesh = make_icosahedron();
    for (int i = 0; i < subdivisions; ++i) mesh = subdivide(std::move(mesh));
    for (Vec3& vertex : mesh.vertices) vertex *= radius_m(vertex);
    return mesh;
}

TriangleMesh make_ball(int subdivisions, double radius_m) {
    return make_radial_surface(subdivisions, [=](const Vec3&) { return radius_m; });
}

TriangleMesh make_torus(double ring_radius_m, double tube_radius_m, int around, int across) {
    TriangleMesh mesh;
    const auto index = [&](int i, int j) {
        return static_cast<std::uint32_t>(i % around * across + j % across);
    };
    for (int i = 0; i < around; ++i) {
        const double ring = 2.0 * core::kPi * i / around;
        for (int j = 0; j < across; ++j) {
            const double tube = 2.0 * core::kPi * j / across;
            const double radius = ring_radius_m + tube_radius_m * std::cos(tube);
            mesh.vertices.emplace_back(
                radius * std::cos(ring), radius * std::sin(ring), tube_radius_m * std::sin(tube));
            mesh.triangles.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
            mesh.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
        }
    }
    return mesh;
}

TriangleMesh rotated(TriangleMesh mesh, const Vec3& axis, double angle_deg) {
    const core::Mat3 rotation =
        Eigen::AngleAxisd(angle_deg * core::kPi / 180.0, axis).toRotationMatrix();
    for (Vec3& vertex : mesh.vertices) vertex = rotation * vertex;
    return mesh;
}

renderer::Object place(const std::string& name,
                       TriangleMesh mesh,
                       const Vec3& origin,
                       const renderer::Material& material) {
    renderer::Object object;
    object.name = name;
    object.material = material;
    object.world_from_node.translation() = origin;
    for (Vec3& vertex : mesh.vertices) vertex = vertex.unaryExpr(&as_stored) + origin;
    object.mesh = std::move(mesh);
    return object;
}

renderer::Material diffuse(double albedo) {
    renderer::Material material;
    material.name = "diffuse";
    material.albedo = albedo;
    return material;
}

renderer::Material conductor(const std::string& name, double albedo, double roughness) {
    renderer::Material material = diffuse(albedo);
    material.name = name;
    material.model = renderer::model_of({.metallic = true});
    material.roughness = roughness;
    return material;
}

}  // namespace scenes
