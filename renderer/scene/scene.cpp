// SPDX-License-Identifier: MIT
#include "renderer/scene/scene.h"

#include "renderer/scene/load_geometry.h"

#include <algorithm>

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

Vec2 texture_coordinates(const Object& object, const Facet& facet, const Vec3& position) {
    // Barycentric weights by least squares in the facet's plane.
    const Vec3 offset = position - facet.corner;
    const double g11 = facet.edge1.squaredNorm();
    const double g12 = facet.edge1.dot(facet.edge2);
    const double g22 = facet.edge2.squaredNorm();
    const double p1 = offset.dot(facet.edge1);
    const double p2 = offset.dot(facet.edge2);
    const double determinant = g11 * g22 - g12 * g12;
    const double b1 = (g22 * p1 - g12 * p2) / determinant;
    const double b2 = (g11 * p2 - g12 * p1) / determinant;
    const auto& [i0, i1, i2] = object.mesh.triangles[facet.triangle];
    return (1.0 - b1 - b2) * object.uv[i0] + b1 * object.uv[i1] + b2 * object.uv[i2];
}

// A grid lies on the rectangle of `relay_wall`; a mesh in its place has to be there as well.
void require_on_wall_mesh(const Scene& scene,
                          const core::WallPoints& points,
                          const std::string& key) {
    constexpr double kTolerance_m = 1e-3;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3& normal = points.normals[i];
        const Vec3 above = points.positions[i] + kTolerance_m * normal;
        const auto hit = scene.first_hit(above, -normal, -normal);
        if (hit && !scene.is_hidden(hit->facet) &&
            (hit->position - points.positions[i]).norm() < kTolerance_m) {
            continue;
        }
        throw core::Error("scan." + key,
                          "found a grid that does not lie on the mesh with the role relay_wall",
                          "must be given as explicit points: " + key + "_m and normals");
    }
}

}  // namespace

Scene::Scene(SceneGeometry geometry, const core::Scan& scan, const RelayWall& wall)
    : geometry_(with_wall(std::move(geometry), scan, wall)),
      facets_(make_facets(geometry_)),
      wall_albedo_(wall.albedo),
      rays_(corners_of(facets_), scan.path_ends()) {
    for (const Object& object : geometry_.objects) bsdfs_.push_back(make_bsdf(object.material));
    if (const Object* mesh = relay_wall_mesh(geometry_)) {
        has_relay_wall_ = true;
        wall_albedo_ = mesh->material.albedo;
    }
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
    if (object.material.albedo_texture) {
        const Vec2 uv = texture_coordinates(object, facet, point.position);
        const double factor = object.material.albedo_texture->lookup(uv);
        std::visit([&](auto& model) { model.albedo *= factor; }, bsdf);
    }
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
    const auto* wall = scan.as<core::WallScan>();
    const auto in_front = [&](const Object& object) {
        if (object.role == Role::RelayWall) return false;
        for (std::size_t i = 0; i < wall->sensing.size(); ++i) {
            for (const Vec3& vertex : object.mesh.vertices) {
                if (wall->sensing.normals[i].dot(vertex - wall->sensing.positions[i]) > 0.0) {
                    return true;
                }
            }
        }
        return false;
    };
    if (wall != nullptr &&
        std::none_of(geometry.objects.begin(), geometry.objects.end(), in_front)) {
        throw core::Error(
            geometry_name(description),
            "found no hidden surface in front of the relay wall",
            std::string("must have one on the side that the wall's normal points to") +
                (is_mesh_file(description.geometry)
                     ? " (geometry_unit_m and geometry_up place a mesh file)"
                     : ""));
    }
    const bool has_wall_mesh = relay_wall_mesh(geometry) != nullptr;
    if (has_wall_mesh && scan.as<core::SensorScan>() != nullptr) {
        throw core::Error(geometry_name(description),
                          "found a mesh with the role relay_wall and a scan of pattern sensor",
                          "must have none: a sensor looks at the rectangle relay_wall");
    }
    Scene scene(std::move(geometry), scan, description.relay_wall);
    if (has_wall_mesh && wall != nullptr) {
        const ScanSettings& asked = description.scan;
        if (asked.sensing_points_m.empty()) {
            require_on_wall_mesh(scene, wall->sensing, "sensing_points");
        }
        if (asked.pattern == core::ScanPattern::Exhaustive && asked.illumination_points_m.empty()) {
            require_on_wall_mesh(scene, wall->illumination, "illumination_points");
        }
    }
    return scene;
}

Scene load_scene(const SceneDescription& description, const core::Scan& scan) {
    return make_scene(load_geometry(description), description, scan);
}

}  // namespace renderer
