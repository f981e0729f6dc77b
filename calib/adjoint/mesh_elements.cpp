// SPDX-License-Identifier: MIT
#include "calib/adjoint/adjoint_scene.h"
#include "calib/forward/model_elements.h"

#include <algorithm>

namespace calib {
namespace {

using core::Vec3;

MeshElement element_of(const std::array<Vec3, 3>& facet, const ModelElement& part) {
    std::array<Vec3, 3> corners;
    for (std::size_t j = 0; j < 3; ++j) {
        const Vec3& weights = part.barycentric[j];
        corners[j] = weights[0] * facet[0] + weights[1] * facet[1] + weights[2] * facet[2];
    }
    MeshElement element{part.facet, part.barycentric, element_shape(corners)};
    const Vec3 center = (corners[0] + corners[1] + corners[2]) / 3.0;
    for (const Vec3& corner : corners) {
        element.radius_m = std::max(element.radius_m, (corner - center).norm());
    }
    return element;
}

}  // namespace

std::vector<MeshElement> cut_mesh(const core::TriangleMesh& mesh,
                                  const FacetTree& tree,
                                  const core::WallScan& scan,
                                  double smear_m,
                                  double tolerance) {
    std::vector<ModelElement> parts;
    std::vector<MeshElement> elements;
    for (const std::uint32_t facet : tree.order()) {
        const auto& [a, b, c] = mesh.triangles[facet];
        const std::array<Vec3, 3> corners{mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
        if (!core::has_area(corners[1] - corners[0], corners[2] - corners[0])) continue;
        const std::size_t first = parts.size();
        append_elements(corners, facet, scan, smear_m, tolerance, parts);
        for (std::size_t i = first; i < parts.size(); ++i) {
            elements.push_back(element_of(corners, parts[i]));
        }
    }
    return elements;
}

}  // namespace calib
