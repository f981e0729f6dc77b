// SPDX-License-Identifier: MIT
#include "renderer/scene/ground_truth.h"

#include "renderer/core/system/parallel.h"

namespace renderer {
namespace {

using core::Vec3;

std::optional<SurfacePoint> first_hidden_hit(const Scene& scene, Vec3 from, const Vec3& direction) {
    Vec3 normal = direction;
    // Every wall facet met is passed once, so the loop ends.
    for (std::size_t passed = 0; passed <= scene.facets().size(); ++passed) {
        const auto hit = scene.first_hit(from, normal, direction);
        if (!hit || scene.is_hidden(hit->facet)) return hit;
        from = hit->position;
        normal = scene.facet(hit->facet).normal;
    }
    return std::nullopt;
}

std::vector<double> cell_centers(double size, int count) {
    std::vector<double> centers;
    for (int i = 0; i < count; ++i) centers.push_back(size * ((i + 0.5) / count - 0.5));
    return centers;
}

}  // namespace

core::DepthMap trace_depth_map(const Scene& scene,
                               const core::Transform& world_from_wall,
                               std::vector<double> x_m,
                               std::vector<double> y_m) {
    core::DepthMap map(std::move(x_m), std::move(y_m));
    map.world_from_wall = world_from_wall;
    map.normals.assign(map.depth_m.size(), Vec3::Zero());
    map.albedo.assign(map.depth_m.size(), 0.0);
    map.object.assign(map.depth_m.size(), 0);
    const Vec3 direction = world_from_wall.linear().col(2);
    core::parallel_for(map.x_m.size(), [&](std::size_t ix) {
        for (std::size_t iy = 0; iy < map.y_m.size(); ++iy) {
            const Vec3 start = world_from_wall * Vec3(map.x_m[ix], map.y_m[iy], 0.0);
            const auto hit = first_hidden_hit(scene, start, direction);
            if (!hit) continue;
            const std::size_t i = map.index(ix, iy);
            const Vec3& normal = scene.facet(hit->facet).normal;
            map.depth_m[i] = (hit->position - start).dot(direction);
            map.normals[i] = normal.dot(direction) > 0.0 ? Vec3(-normal) : normal;
            map.albedo[i] = albedo_of(scene.bsdf_at(*hit));
            map.object[i] = scene.facet(hit->facet).object;
        }
    });
    return map;
}

core::DepthMap trace_ground_truth(const Scene& scene, const SceneDescription& description) {
    const RelayWall& wall = description.relay_wall;
    const auto& [nx, ny] = description.ground_truth.depth_resolution;
    return trace_depth_map(scene,
                           wall.world_from_wall(),
                           cell_centers(wall.size_m[0], nx),
                           cell_centers(wall.size_m[1], ny));
}

}  // namespace renderer
