// SPDX-License-Identifier: MIT
#pragma once

#include "calib/model/scene_model.h"
#include "renderer/core/capture/capture.h"
#include "renderer/geometry/visibility_mask.h"

#include <array>
#include <cstdint>
#include <vector>

namespace calib {

/// A part of a facet small enough for the closed-form kernel, by its corners' weights of the
/// facet's corners; it moves with the facet.
struct ModelElement {
    std::uint32_t facet = 0;
    std::array<core::Vec3, 3> barycentric;
    double area_fraction = 1.0;  ///< of the facet
};

/// Cuts a triangle by bisection of its longest edges and appends its elements.
///
/// The Gaussian kernel's relative L2 error is at most 0.05 h^2 / (8 r s), h the longest edge, r the
/// distance and s the response's width in range; without a response half a bin stands for s.
///
/// sigma_m     standard deviation of the response in path length [m], or half the bin's width
/// tolerance   relative L2 error aimed at
/// throws      core::Failure beyond 200,000 elements
/// source      rule measured, see README.md
void append_elements(const std::array<core::Vec3, 3>& corners,
                     std::uint32_t facet,
                     const core::WallScan& scan,
                     double sigma_m,
                     double tolerance,
                     std::vector<ModelElement>& elements);

/// The elements of all facets of a model, where the state puts them.
std::vector<ModelElement> cut_elements(const SceneModel& model,
                                       const SceneState& state,
                                       const core::WallScan& scan,
                                       double sigma_m,
                                       double tolerance);

/// True when no surface of the model can hide another: all lie in one plane.
bool is_planar(const SceneModel& model, const SceneState& state);

/// Which parts of every element each wall point sees, by rays through the renderer's scene.
///
/// The centres of an element's quarters are asked first; only where they disagree, so that the edge
/// of a shadow falls on the element, the other parts are asked too.
///
/// returns   masks [point][element]
std::vector<renderer::VisibilityMask> trace_masks(const SceneModel& model,
                                                  const SceneState& state,
                                                  const std::vector<ModelElement>& elements,
                                                  const core::WallScan& scan,
                                                  const core::WallPoints& points);

}  // namespace calib
