// SPDX-License-Identifier: MIT
#include "renderer/scene/scene_checks.h"

#include "renderer/scene/box_tree.h"
#include "renderer/scene/load_geometry.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace renderer {
namespace {

using core::Vec3;

// Nearer surfaces than this fraction of the scene's size would need finer elements than the
// integrator cuts, and soon finer numbers than rays have.
constexpr double kNearest = 1e-4;

bool is_in_front(const Object& object, const core::WallPoints& points) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        for (const Vec3& vertex : object.mesh.vertices) {
            if (points.normals[i].dot(vertex - points.positions[i]) > 0.0) return true;
        }
    }
    return false;
}

// The point of a triangle that is nearest to another point: its foot on the plane if that is
// inside, else the nearest on an edge.
Vec3 nearest_point(const Facet& facet, const Vec3& to) {
    const Vec3& a = facet.corner;
    const Vec3& ab = facet.edge1;
    const Vec3& ac = facet.edge2;
    const auto along = [&](const Vec3& from, const Vec3& edge) {
        const double fraction = edge.dot(to - from) / edge.squaredNorm();
        return Vec3(from + std::clamp(fraction, 0.0, 1.0) * edge);
    };
    const Vec3 foot = to - facet.normal.dot(to - a) * facet.normal;
    const double b1 = facet.normal.dot((foot - a).cross(ac)) / (2.0 * facet.area_m2);
    const double b2 = facet.normal.dot(ab.cross(foot - a)) / (2.0 * facet.area_m2);
    if (b1 >= 0.0 && b2 >= 0.0 && b1 + b2 <= 1.0) return foot;
    const std::array edges{along(a, ab), along(a, ac), along(a + ab, ac - ab)};
    return *std::min_element(edges.begin(), edges.end(), [&](const Vec3& p, const Vec3& q) {
        return (p - to).squaredNorm() < (q - to).squaredNorm();
    });
}

BoxTree::Box box_around(const Vec3& point, double radius_m) {
    const Vec3 reach = Vec3::Constant(radius_m);
    return {Vec3(point - reach), Vec3(point + reach)};
}

BoxTree::Box box_of(const Facet& facet) {
    BoxTree::Box box;
    for (const Vec3& corner : facet.corners()) box.extend(corner);
    return box;
}

void require_distance(const Scene& scene, const core::WallPoints& points) {
    const double least_m = 2.0 * kNearest * scene.rays().half_size_m();
    BoxTree::Box wall;
    for (const Vec3& point : points.positions) {
        wall.extend(box_around(point, least_m));
    }
    std::vector<std::uint32_t> facets;
    std::vector<BoxTree::Box> boxes;
    for (std::uint32_t f = 0; f < scene.facets().size(); ++f) {
        const BoxTree::Box box = box_of(scene.facet(f));
        if (!scene.is_hidden(f) || !box.intersects(wall)) continue;
        facets.push_back(f);
        boxes.push_back(box);
    }
    const BoxTree tree(boxes);
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3& point = points.positions[i];
        tree.find(box_around(point, least_m), [&](std::uint32_t found) {
            const Vec3 way = nearest_point(scene.facet(facets[found]), point) - point;
            const bool is_near = way.norm() < least_m;
            // Surfaces on the wall send it no light.
            const bool is_before = points.normals[i].dot(way) > 4.0 * scene.stated_rounding_m();
            if (!is_near || !is_before) return;
            throw core::Error(
                "object " + scene.object_of(facets[found]).name,
                fmt::format("found {:.3g} m in front of the wall point {} m",
                            way.norm(),
                            core::vector_text(point)),
                fmt::format("must keep {:.2g} m from lit and sensed points, {:g} of the scene's "
                            "size, or be on the wall or behind it",
                            least_m,
                            kNearest));
        });
    }
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

// Where a point lies off the rectangle of the relay wall, in words; nothing on it.
std::optional<std::string> place_off_wall(const core::RelayWall& wall, const Vec3& point) {
    constexpr double kTolerance = 0.02;  // of the wall's size: points are measured, too
    const double size_m = std::hypot(wall.size_m[0], wall.size_m[1]);
    const Vec3 local = wall.world_from_wall().inverse(Eigen::Isometry) * point;
    if (std::abs(local.z()) > kTolerance * size_m) {
        return fmt::format("{:.3g} m {} the relay wall",
                           std::abs(local.z()),
                           local.z() < 0.0 ? "behind" : "in front of");
    }
    const double beside_m = std::max(std::abs(local.x()) - 0.5 * wall.size_m[0],
                                     std::abs(local.y()) - 0.5 * wall.size_m[1]);
    if (beside_m <= kTolerance * size_m) return std::nullopt;
    return fmt::format("{:.3g} m beside the relay wall", beside_m);
}

void warn_of_points_off_wall(const core::RelayWall& wall,
                             const core::WallPoints& points,
                             const std::string& key,
                             std::vector<std::string>& warnings) {
    for (const Vec3& point : points.positions) {
        const auto place = place_off_wall(wall, point);
        if (!place) continue;
        warnings.push_back(fmt::format("the point {} m lies {}; {} or relay_wall places it",
                                       core::vector_text(point),
                                       *place,
                                       key));
        return;
    }
}

// A mesh around its own origin is the commonest: it has to be moved in front of the wall.
void warn_of_objects_behind_wall(const core::RelayWall& wall,
                                 const std::vector<Object>& objects,
                                 std::vector<std::string>& warnings) {
    constexpr double kNotable = 0.1;  // of an object's extent in depth
    const core::Transform wall_from_world = wall.world_from_wall().inverse(Eigen::Isometry);
    for (const Object& object : objects) {
        double low_m = std::numeric_limits<double>::infinity();
        double high_m = -low_m;
        for (const Vec3& vertex : object.mesh.vertices) {
            const double depth_m = (wall_from_world * vertex).z();
            low_m = std::min(low_m, depth_m);
            high_m = std::max(high_m, depth_m);
        }
        if (!(high_m > 0.0) || -low_m < kNotable * (high_m - low_m)) continue;
        warnings.push_back(fmt::format(
            "object {} reaches from {:.3g} m behind the relay wall to {:.3g} m in front of "
            "it, and only what is in front counts; relay_wall.center_m moves the wall",
            object.name,
            -low_m,
            high_m));
    }
}

}  // namespace

void warn_of_placement(const SceneDescription& description,
                       const core::Scan& scan,
                       SceneGeometry& geometry) {
    const auto* points = scan.as<core::WallScan>();
    if (points == nullptr) return;
    const core::RelayWall& wall = description.relay_wall;
    warn_of_points_off_wall(wall, points->sensing, "scan.sensing_points_m", geometry.warnings);
    if (!points->is_confocal()) {
        warn_of_points_off_wall(
            wall, points->illumination, "scan.illumination_m", geometry.warnings);
    }
    warn_of_objects_behind_wall(wall, geometry.objects, geometry.warnings);
}

void check_geometry(const SceneGeometry& geometry,
                    const SceneDescription& description,
                    const core::Scan& scan) {
    for (const Object& object : geometry.objects) {
        for (const Vec3& vertex : object.mesh.vertices) {
            if (vertex.allFinite()) continue;
            throw core::Error("object " + object.name,
                              "has a vertex that is not finite",
                              "must have finite ones");
        }
    }
    const auto* wall = scan.as<core::WallScan>();
    const bool is_any_in_front =
        wall == nullptr || std::ranges::any_of(geometry.objects, [&](const Object& object) {
            return object.role != Role::RelayWall && is_in_front(object, wall->sensing);
        });
    if (!is_any_in_front) {
        throw core::Error(
            geometry_name(description),
            "found no hidden surface in front of the relay wall",
            std::string("must have one on the side that the wall's normal points to") +
                (is_mesh_file(description.geometry)
                     ? " (geometry_unit_m and geometry_up place a mesh file)"
                     : ""));
    }
    const bool has_wall_mesh = std::ranges::any_of(
        geometry.objects, [](const Object& object) { return object.role == Role::RelayWall; });
    if (has_wall_mesh && scan.as<core::SensorScan>() != nullptr) {
        throw core::Error(geometry_name(description),
                          "found a mesh with the role relay_wall and a scan of pattern sensor",
                          "must have none: a sensor looks at the rectangle relay_wall");
    }
}

void check_scene(const Scene& scene, const SceneDescription& description, const core::Scan& scan) {
    const auto* wall = scan.as<core::WallScan>();
    if (wall == nullptr) return;
    const bool has_hidden = std::ranges::any_of(
        scene.objects(), [](const Object& object) { return object.role != Role::RelayWall; });
    if (!has_hidden) {
        throw core::Error(geometry_name(description),
                          "found all its surfaces on the relay wall",
                          "must have one in front of it");
    }
    require_distance(scene, wall->sensing);
    if (!wall->is_confocal()) require_distance(scene, wall->illumination);
}

void check_wall_mesh(const Scene& scene,
                     const SceneDescription& description,
                     const core::Scan& scan) {
    const auto* wall = scan.as<core::WallScan>();
    if (wall == nullptr) return;
    const ScanSettings& asked = description.scan;
    if (asked.sensing_points_m.empty()) {
        require_on_wall_mesh(scene, wall->sensing, "sensing_points");
    }
    if (asked.pattern == core::ScanPattern::Exhaustive && asked.illumination_points_m.empty()) {
        require_on_wall_mesh(scene, wall->illumination, "illumination_points");
    }
}

}  // namespace renderer
