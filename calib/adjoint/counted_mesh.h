// SPDX-License-Identifier: MIT
#pragma once

#include "calib/adjoint/adjoint_scene.h"
#include "renderer/core/mesh.h"

#include <array>
#include <cstdint>
#include <vector>

namespace calib {

/// What counts of a mesh where facets lie at one place, see renderer::find_covered_faces(): the
/// first of them, and what it leaves of the others.
class CountedMesh {
 public:
    explicit CountedMesh(core::TriangleMesh mesh);

    /// The vertices as given, then those of the parts that are left.
    const core::TriangleMesh& mesh() const { return mesh_; }

    /// Values per facet of mesh() from those per facet as given.
    std::vector<double> of_facets(const std::vector<double>& values) const;

    /// Gradients by the mesh as given from those by mesh(). Parts keep their places on facets.
    MeshGradients gradients_as_given(const MeshGradients& gradients) const;

 private:
    /// A vertex on a facet.
    struct AddedVertex {
        std::array<std::uint32_t, 3> corners{};  ///< vertices as given
        core::Vec3 weights;
    };

    core::TriangleMesh mesh_;
    std::size_t num_vertices_ = 0;       ///< as given
    std::size_t num_facets_ = 0;         ///< as given
    std::vector<AddedVertex> added_;     ///< behind the vertices as given
    std::vector<std::uint32_t> facets_;  ///< as given, per facet of mesh(); empty: all are
};

}  // namespace calib
