// SPDX-License-Identifier: MIT
#include "renderer/scene/ground_truth.h"

#include "renderer/core/system/parallel.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

using core::Vec3;

constexpr double kSamplesPerSide = 4.0;  // of a column, at least
constexpr double kMostSamples = 4e6;     // of all columns

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

core::TrueSurface trace_true_surface(const Scene& scene,
                                     const core::Transform& world_from_wall,
                                     const std::vector<double>& x_m,
                                     const std::vector<double>& y_m,
                                     double spacing_m) {
    const double column_m = std::max(core::spacing_m(x_m), core::spacing_m(y_m));
    const auto columns = static_cast<double>(x_m.size() * y_m.size());
    const auto most = std::max(1.0, std::floor(std::sqrt(kMostSamples / columns)));
    const auto wanted = std::max(kSamplesPerSide, std::ceil(column_m / spacing_m));
    const auto per_side = static_cast<std::size_t>(std::min(wanted, most));
    return {trace_depth_map(scene,
                            world_from_wall,
                            core::parts_of_cells(x_m, per_side),
                            core::parts_of_cells(y_m, per_side)),
            per_side};
}

core::TrueSurface trace_true_surface(const Scene& scene,
                                     const SceneDescription& description,
                                     const core::Transform& world_from_wall,
                                     const std::vector<double>& x_m,
                                     const std::vector<double>& y_m) {
    const auto& size_m = description.relay_wall.size_m;
    const auto& [nx, ny] = description.ground_truth.depth_resolution;
    return trace_true_surface(
        scene, world_from_wall, x_m, y_m, std::min(size_m[0] / nx, size_m[1] / ny));
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
