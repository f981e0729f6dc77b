// SPDX-License-Identifier: MIT
#pragma once

#include "calib/adjoint/facet_tree.h"
#include "calib/adjoint/mesh_elements.h"
#include "renderer/core/capture/capture.h"
#include "renderer/core/mesh.h"

#include <vector>

namespace calib {

/// Gradients of a number by a mesh.
struct MeshGradients {
    std::vector<core::Vec3> vertices;  ///< per vertex [1/m]
    std::vector<double> albedo;        ///< per facet

    explicit MeshGradients(const core::TriangleMesh& mesh)
        : vertices(mesh.vertices.size(), core::Vec3::Zero()), albedo(mesh.triangles.size(), 0.0) {}

    MeshGradients& operator+=(const MeshGradients& other) {
        for (std::size_t i = 0; i < vertices.size(); ++i) vertices[i] += other.vertices[i];
        for (std::size_t i = 0; i < albedo.size(); ++i) albedo[i] += other.albedo[i];
        return *this;
    }
};

/// A mesh and how its third bounce is measured: what all pairs share.
struct AdjointScene {
    const core::TriangleMesh& mesh;
    const std::vector<double>& albedo;  ///< per facet
    const FacetTree& tree;
    const std::vector<MeshElement>& elements;  ///< in the order of the tree
    const core::Scan& scan;
    core::TimeAxis axis;
    double radiance_factor = 1.0;  ///< of an albedo of 1
    double sigma_m = 0.0;          ///< of a Gaussian response, in path length
};

}  // namespace calib
