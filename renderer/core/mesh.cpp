// SPDX-License-Identifier: MIT
#include "renderer/core/mesh.h"

#include "renderer/core/error.h"
#include "renderer/core/random.h"
#include "renderer/core/sampling.h"

#include <algorithm>
#include <numeric>

namespace core {

void append_mesh(const TriangleMesh& mesh, TriangleMesh& target) {
    const auto base = static_cast<std::uint32_t>(target.vertices.size());
    target.vertices.insert(target.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
    for (const auto& [a, b, c] : mesh.triangles) {
        target.triangles.push_back({base + a, base + b, base + c});
    }
}

bool has_area(const Vec3& ab, const Vec3& ac) {
    constexpr double kSmallestAspect = 1e-12;  // far above rounding, far below any real sliver
    const double longest = std::max({ab.norm(), ac.norm(), (ac - ab).norm()});
    return longest > 0.0 && (ab / longest).cross(ac / longest).norm() > kSmallestAspect;
}

PointCloud sample_surface(const TriangleMesh& mesh, std::size_t count, std::uint64_t seed) {
    std::vector<Vec3> area_vectors;
    std::vector<double> areas;
    for (const auto& [a, b, c] : mesh.triangles) {
        area_vectors.push_back(
            triangle_area_vector(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]));
        areas.push_back(area_vectors.back().norm());
    }
    const double total = std::accumulate(areas.begin(), areas.end(), 0.0);
    if (!(total > 0.0)) throw Error("mesh", "has no area", "must have a triangle of positive area");

    const DiscreteDistribution by_area(areas);
    PointCloud cloud;
    Rng rng(seed, 0, 0);
    for (std::size_t i = 0; i < count; ++i) {
        double u = 0.0;
        const std::size_t index = by_area.sample(rng.uniform(), u);
        const Vec2 b = sample_triangle({u, rng.uniform()});
        const auto& [v0, v1, v2] = mesh.triangles[index];
        cloud.positions.push_back((1.0 - b.sum()) * mesh.vertices[v0] + b.x() * mesh.vertices[v1] +
                                  b.y() * mesh.vertices[v2]);
        cloud.normals.push_back(area_vectors[index] / areas[index]);
    }
    return cloud;
}

}  // namespace core
