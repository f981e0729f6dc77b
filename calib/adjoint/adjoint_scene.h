// SPDX-License-Identifier: MIT
#pragma once

#include "calib/adjoint/facet_tree.h"
#include "calib/adjoint/part_kernel.h"
#include "renderer/core/capture/capture.h"
#include "renderer/core/mesh.h"

#include <array>
#include <cstdint>
#include <vector>

namespace calib {

/// A part of a facet, small enough for the kernel.
struct MeshElement {
    std::uint32_t facet = 0;
    std::array<core::Vec3, 3> barycentric;  ///< of its corners in the facet
    ElementShape shape;
    double radius_m = 0.0;  ///< about the mean of its corners
};

/// What both ends of a pair see of an element.
enum class ElementVisibility : std::uint8_t { Unknown, Hidden, Whole, Part };

/// Cuts all facets with an area, in the order of their tree, by the rules of append_elements().
std::vector<MeshElement> cut_mesh(const core::TriangleMesh& mesh,
                                  const FacetTree& tree,
                                  const core::WallScan& scan,
                                  double smear_m,
                                  double tolerance);

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
    const core::WallScan& scan;
    core::TimeAxis axis;
    double radiance_factor = 1.0;  ///< of an albedo of 1
    double sigma_m = 0.0;          ///< of a Gaussian response, in path length
};

}  // namespace calib
