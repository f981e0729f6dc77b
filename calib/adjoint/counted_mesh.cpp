// SPDX-License-Identifier: MIT
#include "calib/adjoint/counted_mesh.h"

#include "renderer/scene/coincident_faces.h"

#include <utility>

namespace calib {
namespace {

std::vector<renderer::CoveredFace> covered_facets(const core::TriangleMesh& mesh) {
    std::vector<renderer::Object> objects(1);
    objects[0].mesh = mesh;
    // No rays in single precision are to tell facets apart: the least distance that counts as one.
    return renderer::find_covered_faces(
        objects, renderer::FacePrecedence(objects), renderer::coincidence_m({}, {}));
}

}  // namespace

CountedMesh::CountedMesh(core::TriangleMesh mesh)
    : mesh_(std::move(mesh)),
      num_vertices_(mesh_.vertices.size()),
      num_facets_(mesh_.triangles.size()) {
    const std::vector<renderer::CoveredFace> covered = covered_facets(mesh_);
    if (covered.empty()) return;
    const auto facets = std::exchange(mesh_.triangles, {});
    mesh_.normals.clear();
    auto next = covered.begin();
    for (std::uint32_t facet = 0; facet < facets.size(); ++facet) {
        if (next == covered.end() || next->face != facet) {
            mesh_.triangles.push_back(facets[facet]);
            facets_.push_back(facet);
            continue;
        }
        const auto& corners = facets[facet];
        for (const std::array<core::Vec2, 3>& part : next->rest) {
            const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
            for (const core::Vec2& w : part) {
                const core::Vec3 weights(1.0 - w.x() - w.y(), w.x(), w.y());
                core::Vec3 place = core::Vec3::Zero();
                for (std::size_t i = 0; i < 3; ++i) {
                    place += weights[static_cast<Eigen::Index>(i)] * mesh_.vertices[corners[i]];
                }
                mesh_.vertices.push_back(place);
                added_.push_back({corners, weights});
            }
            mesh_.triangles.push_back({first, first + 1, first + 2});
            facets_.push_back(facet);
        }
        ++next;
    }
}

std::vector<double> CountedMesh::of_facets(const std::vector<double>& values) const {
    if (facets_.empty()) return values;
    std::vector<double> counted;
    for (const std::uint32_t facet : facets_) counted.push_back(values[facet]);
    return counted;
}

MeshGradients CountedMesh::gradients_as_given(const MeshGradients& gradients) const {
    if (facets_.empty()) return gradients;
    MeshGradients given = gradients;
    given.vertices.resize(num_vertices_);
    for (std::size_t i = 0; i < added_.size(); ++i) {
        const core::Vec3& by_place = gradients.vertices[num_vertices_ + i];
        for (std::size_t k = 0; k < 3; ++k) {
            given.vertices[added_[i].corners[k]] +=
                added_[i].weights[static_cast<Eigen::Index>(k)] * by_place;
        }
    }
    given.albedo.assign(num_facets_, 0.0);
    for (std::size_t i = 0; i < facets_.size(); ++i) {
        given.albedo[facets_[i]] += gradients.albedo[i];
    }
    return given;
}

}  // namespace calib
