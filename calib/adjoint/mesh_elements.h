// SPDX-License-Identifier: MIT
#pragma once

#include "calib/adjoint/facet_tree.h"
#include "calib/adjoint/piece_kernel.h"
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
                                  const core::Scan& scan,
                                  double smear_m,
                                  double tolerance);

}  // namespace calib
