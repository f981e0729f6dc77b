// SPDX-License-Identifier: MIT
#include "renderer/scene/ground_truth.h"

#include "renderer/core/system/parallel.h"

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

using core::Vec3;

constexpr double kSamplesPerSide = 4.0;  // of a column, at least
constexpr double kMostSamples = 1e6;     // of all columns

constexpr int kObservers = 5;           // along each side of the view
constexpr std::size_t kMostLayers = 4;  // surfaces one behind another

/// Calls visit(hit) for the hidden surfaces along a ray, nearest first, until it returns false.
template <class Visit>
void visit_hidden_hits(const Scene& scene, Vec3 from, const Vec3& direction, Visit&& visit) {
    Vec3 normal = direction;
    // Every facet met is passed once, so the loop ends.
    for (std::size_t passed = 0; passed <= scene.facets().size(); ++passed) {
        const auto hit = scene.first_hit(from, normal, direction);
        if (!hit || (scene.is_hidden(hit->facet) && !visit(*hit))) return;
        from = hit->position;
        normal = scene.facet(hit->facet).normal;
    }
}

/// Enters what a ray from the wall sees at a hit.
void enter(const Scene& scene,
           const SurfacePoint& hit,
           double depth_m,
           std::size_t i,
           core::DepthMap& map) {
    const Vec3 direction = map.world_from_wall.linear().col(2);
    const Vec3& normal = scene.facet(hit.facet).normal;
    map.depth_m[i] = depth_m;
    map.normals[i] = normal.dot(direction) > 0.0 ? Vec3(-normal) : normal;
    map.albedo[i] = albedo_of(scene.bsdf_at(hit));
    map.object[i] = scene.facet(hit.facet).object;
}

core::DepthMap background(const core::Transform& world_from_wall,
                          std::vector<double> x_m,
                          std::vector<double> y_m) {
    core::DepthMap map(std::move(x_m), std::move(y_m));
    map.world_from_wall = world_from_wall;
    map.normals.assign(map.depth_m.size(), Vec3::Zero());
    map.albedo.assign(map.depth_m.size(), 0.0);
    map.object.assign(map.depth_m.size(), 0);
    return map;
}

std::vector<double> cell_centers(double size, int count) {
    std::vector<double> centers;
    for (int i = 0; i < count; ++i) centers.push_back(size * ((i + 0.5) / count - 0.5));
    return centers;
}

/// Points of the view's plane z = 0, evenly spaced over its columns [world].
std::vector<Vec3> observers_of(const core::DepthMap& view) {
    const auto width = [](const std::vector<double>& centres_m) {
        return centres_m.back() - centres_m.front() + core::spacing_m(centres_m);
    };
    const Vec3 centre(0.5 * (view.x_m.front() + view.x_m.back()),
                      0.5 * (view.y_m.front() + view.y_m.back()),
                      0.0);
    std::vector<Vec3> points;
    for (const double x : cell_centers(width(view.x_m), kObservers)) {
        for (const double y : cell_centers(width(view.y_m), kObservers)) {
            points.push_back(view.world_from_wall * (centre + Vec3(x, y, 0.0)));
        }
    }
    return points;
}

/// What the view sees, and behind it the surfaces that it sees from elsewhere on its plane.
std::vector<core::DepthMap> trace_layers(const Scene& scene, const core::DepthMap& empty) {
    std::vector<core::DepthMap> layers(kMostLayers, empty);
    const std::vector<Vec3> observers = observers_of(empty);
    const Vec3 direction = empty.world_from_wall.linear().col(2);
    core::parallel_for(empty.x_m.size(), [&](std::size_t ix) {
        for (std::size_t iy = 0; iy < empty.y_m.size(); ++iy) {
            const Vec3 start = empty.world_from_wall * Vec3(empty.x_m[ix], empty.y_m[iy], 0.0);
            std::size_t layer = 0;
            visit_hidden_hits(scene, start, direction, [&](const SurfacePoint& hit) {
                const Vec3& normal = scene.facet(hit.facet).normal;
                const auto sees = [&](const Vec3& observer) {
                    return !scene.rays().is_blocked(observer, direction, hit.position, normal);
                };
                if (layer > 0 && std::ranges::none_of(observers, sees)) return true;
                const double depth_m = (hit.position - start).dot(direction);
                enter(scene, hit, depth_m, empty.index(ix, iy), layers[layer]);
                return ++layer < kMostLayers;
            });
        }
    });
    return layers;
}

}  // namespace

core::DepthMap trace_depth_map(const Scene& scene,
                               const core::Transform& world_from_wall,
                               std::vector<double> x_m,
                               std::vector<double> y_m) {
    core::DepthMap map = background(world_from_wall, std::move(x_m), std::move(y_m));
    const Vec3 direction = world_from_wall.linear().col(2);
    core::parallel_for(map.x_m.size(), [&](std::size_t ix) {
        for (std::size_t iy = 0; iy < map.y_m.size(); ++iy) {
            const Vec3 start = world_from_wall * Vec3(map.x_m[ix], map.y_m[iy], 0.0);
            visit_hidden_hits(scene, start, direction, [&](const SurfacePoint& hit) {
                enter(scene, hit, (hit.position - start).dot(direction), map.index(ix, iy), map);
                return false;
            });
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
    const auto wanted = std::max(kSamplesPerSide, std::ceil(column_m / spacing_m - 1e-6));
    const auto per_side = static_cast<std::size_t>(std::min(wanted, most));
    return {trace_layers(scene,
                         background(world_from_wall,
                                    core::parts_of_cells(x_m, per_side),
                                    core::parts_of_cells(y_m, per_side))),
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

core::TrueSurface trace_true_surface(const Scene& scene, const SceneDescription& description) {
    const RelayWall& wall = description.relay_wall;
    const auto& [nx, ny] = description.ground_truth.depth_resolution;
    return trace_true_surface(scene,
                              description,
                              wall.world_from_wall(),
                              cell_centers(wall.size_m[0], nx),
                              cell_centers(wall.size_m[1], ny));
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
