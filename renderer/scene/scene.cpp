// SPDX-License-Identifier: MIT
#include "renderer/scene/scene.h"

#include "renderer/scene/load_geometry.h"
#include "renderer/scene/scene_checks.h"
#include "renderer/scene/weld.h"

#include <algorithm>
#include <limits>

namespace renderer {
namespace {

using core::Vec2;
using core::Vec3;

Object rectangle_object(const RelayWall& wall) {
    Object object;
    object.name = "relay_wall";
    object.role = Role::RelayWall;
    object.material.albedo = wall.albedo;
    const core::Transform world_from_wall = wall.world_from_wall();
    const double x = 0.5 * wall.size_m[0];
    const double y = 0.5 * wall.size_m[1];
    for (const Vec3& corner : {Vec3(-x, -y, 0), Vec3(x, -y, 0), Vec3(x, y, 0), Vec3(-x, y, 0)}) {
        object.mesh.vertices.push_back(world_from_wall * corner);
    }
    object.mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    return object;
}

const Object* relay_wall_mesh(const SceneGeometry& geometry) {
    const auto it =
        std::find_if(geometry.objects.begin(), geometry.objects.end(), [](const Object& object) {
            return object.role == Role::RelayWall;
        });
    return it == geometry.objects.end() ? nullptr : &*it;
}

SceneGeometry with_wall(SceneGeometry geometry, const core::Scan& scan, const RelayWall& wall) {
    if (!scan.has_wall()) {
        // What relays light in a scan is a surface like any other to a camera.
        for (Object& object : geometry.objects) {
            if (object.role == Role::RelayWall) object.role = Role::Hidden;
        }
        return geometry;
    }
    if (relay_wall_mesh(geometry) == nullptr && rectangle_carries_scan(wall, scan.wall())) {
        geometry.objects.push_back(rectangle_object(wall));
    }
    return geometry;
}

SceneGeometry welded(SceneGeometry geometry) {
    for (Object& object : geometry.objects) weld_vertices(object.mesh);
    return geometry;
}

std::vector<Facet> make_facets(const SceneGeometry& geometry) {
    std::vector<Facet> facets;
    for (std::uint32_t o = 0; o < geometry.objects.size(); ++o) {
        const core::TriangleMesh& mesh = geometry.objects[o].mesh;
        for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
            const auto& [a, b, c] = mesh.triangles[t];
            Facet facet;
            facet.corner = mesh.vertices[a];
            facet.edge1 = mesh.vertices[b] - mesh.vertices[a];
            facet.edge2 = mesh.vertices[c] - mesh.vertices[a];
            const Vec3 area_vector = 0.5 * facet.edge1.cross(facet.edge2);
            facet.area_m2 = area_vector.norm();
            facet.normal = area_vector / facet.area_m2;
            facet.object = o;
            facet.triangle = t;
            facets.push_back(facet);
        }
    }
    return facets;
}

std::vector<std::array<Vec3, 3>> corners_of(std::span<const Facet> facets) {
    std::vector<std::array<Vec3, 3>> corners;
    for (const Facet& facet : facets) corners.push_back(facet.corners());
    return corners;
}

// Of the coordinates of facets [m].
double coordinate_rounding_m(std::span<const Facet> facets) {
    double largest = 0.0;
    for (const Facet& facet : facets) {
        largest = std::max(largest, facet.corner.cwiseAbs().maxCoeff());
    }
    return std::numeric_limits<double>::epsilon() * largest;
}

// Weights of the second and the third corner, by least squares in the facet's plane.
Vec2 corner_weights(const Facet& facet, const Vec3& position) {
    const Vec3 offset = position - facet.corner;
    const double g11 = facet.edge1.squaredNorm();
    const double g12 = facet.edge1.dot(facet.edge2);
    const double g22 = facet.edge2.squaredNorm();
    const double p1 = offset.dot(facet.edge1);
    const double p2 = offset.dot(facet.edge2);
    const double determinant = g11 * g22 - g12 * g12;
    return {(g22 * p1 - g12 * p2) / determinant, (g11 * p2 - g12 * p1) / determinant};
}

}  // namespace

Scene::Scene(SceneGeometry geometry, const core::Scan& scan, const RelayWall& wall)
    : Scene(with_wall(std::move(geometry), scan, wall), scan.path_ends(), wall.albedo) {}

Scene::Scene(SceneGeometry geometry, const std::vector<Vec3>& path_ends, double wall_albedo)
    : geometry_(welded(std::move(geometry))),
      coincident_faces_(leave_out_covered_faces(geometry_.objects,
                                                FacePrecedence(geometry_.objects),
                                                coincidence_m(geometry_.objects, path_ends))),
      facets_(make_facets(geometry_)),
      wall_albedo_(wall_albedo),
      rays_(corners_of(facets_), path_ends),
      stated_rounding_m_(coordinate_rounding_m(facets_)) {
    for (const Object& object : geometry_.objects) bsdfs_.push_back(make_bsdf(object.material));
    if (const Object* mesh = relay_wall_mesh(geometry_)) {
        has_relay_wall_ = true;
        wall_albedo_ = mesh->material.albedo;
    }
}

Scene Scene::moved(const Vec3& way, const core::Scan& scan) const {
    SceneGeometry geometry = geometry_;
    geometry.move(way);
    Scene scene(std::move(geometry), scan.path_ends(), wall_albedo_);
    scene.coincident_faces_ = coincident_faces_;
    scene.stated_rounding_m_ = stated_rounding_m_;
    return scene;
}

const Vec3& Scene::tangent_hint(const Vec3& normal) const {
    // Two edges of one facet cannot both be parallel to the normal.
    const Facet& facet = facets_.front();
    const double across1 = facet.edge1.cross(normal).squaredNorm() / facet.edge1.squaredNorm();
    return across1 > 0.01 ? facet.edge1 : facet.edge2;
}

Bsdf Scene::bsdf_at(const SurfacePoint& point) const {
    const Facet& facet = facets_[point.facet];
    Bsdf bsdf = bsdfs_[facet.object];
    const Object& object = geometry_.objects[facet.object];
    if (object.has_one_albedo()) return bsdf;
    const Vec2 weights = corner_weights(facet, point.position);
    const auto& [a, b, c] = object.mesh.triangles[facet.triangle];
    const auto between = [&](const auto& values) {
        return (1.0 - weights.x() - weights.y()) * values[a] + weights.x() * values[b] +
               weights.y() * values[c];
    };
    double factor = 1.0;
    if (const Texture* texture = object.material.albedo_texture.get()) {
        factor = texture->lookup(Vec2(between(object.uv)));
    }
    if (!object.vertex_albedo.empty()) {
        factor *= std::clamp(between(object.vertex_albedo), 0.0, 1.0);
    }
    std::visit([&](auto& model) { model.albedo *= factor; }, bsdf);
    return bsdf;
}

std::optional<SurfacePoint> Scene::first_hit(const Vec3& from,
                                             const Vec3& normal,
                                             const Vec3& direction) const {
    const auto hit = rays_.first_hit(from, normal, direction);
    if (!hit) return std::nullopt;
    return SurfacePoint{from + hit->distance_m * direction, hit->triangle};
}

Scene make_scene(SceneGeometry geometry,
                 const SceneDescription& description,
                 const core::Scan& scan) {
    for (Object& object : geometry.objects) {
        if (!description.render.dielectric_specular) break;
        SurfaceModel& model = object.material.model;
        if (traits_of(model).gltf == GltfSurface{}) model = model_of({.specular = true});
    }
    check_geometry(geometry, description, scan);
    const bool has_wall_mesh = relay_wall_mesh(geometry) != nullptr;
    if (!has_wall_mesh) warn_of_placement(description, scan, geometry);
    Scene scene(std::move(geometry), scan, description.relay_wall);
    check_scene(scene, description, scan);
    if (has_wall_mesh) check_wall_mesh(scene, description, scan);
    return scene;
}

Scene load_scene(const SceneDescription& description, const core::Scan& scan) {
    return make_scene(load_geometry(description), description, scan);
}

}  // namespace renderer
