// SPDX-License-Identifier: MIT
#include "apps/dataset/mesh_library.h"

#include <meshoptimizer.h>

namespace apps {

core::TriangleMesh simplify_mesh(const core::TriangleMesh& mesh, double tolerance) {
    std::vector<float> positions;
    positions.reserve(3 * mesh.vertices.size());
    for (const core::Vec3& vertex : mesh.vertices) {
        for (const double coordinate : vertex) positions.push_back(static_cast<float>(coordinate));
    }
    constexpr std::size_t kStride = 3 * sizeof(float);
    const float scale = meshopt_simplifyScale(positions.data(), mesh.vertices.size(), kStride);
    std::vector<unsigned> corners;
    for (const auto& triangle : mesh.triangles) {
        corners.insert(corners.end(), triangle.begin(), triangle.end());
    }
    std::vector<unsigned> kept(corners.size());
    kept.resize(meshopt_simplify(kept.data(),
                                 corners.data(),
                                 corners.size(),
                                 positions.data(),
                                 mesh.vertices.size(),
                                 kStride,
                                 0,
                                 static_cast<float>(tolerance) / scale,
                                 0,
                                 nullptr));
    core::TriangleMesh simple;
    simple.vertices = mesh.vertices;
    for (std::size_t i = 0; i + 2 < kept.size(); i += 3) {
        simple.triangles.push_back({kept[i], kept[i + 1], kept[i + 2]});
    }
    return simple.triangles.empty() ? mesh : normalise_mesh(simple, "simplified mesh");
}

}  // namespace apps
