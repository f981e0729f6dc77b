// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/true_surface.h"
#include "renderer/scene/scene.h"

#include <vector>

namespace renderer {

/// Traces what the relay wall sees along its normal: depth, normals, albedo
/// and objects of the hidden scene.
///
/// world_from_wall   frame of the view; rays start in its plane z = 0 and run along +z
/// x_m, y_m          columns in that frame [m]
/// returns           a map with NaN where nothing hidden is met; surfaces of the relay wall are
///                   looked through
core::DepthMap trace_depth_map(const Scene& scene,
                               const core::Transform& world_from_wall,
                               std::vector<double> x_m,
                               std::vector<double> y_m);

/// What reconstructions on these columns are scored against: what the wall sees along its normal,
/// and behind that what it sees past it from elsewhere.
///
/// spacing_m   the samples in each column's footprint are no further apart than this [m], nor than
///             a fourth of a column where that needs no more than a million
core::TrueSurface trace_true_surface(const Scene& scene,
                                     const core::Transform& world_from_wall,
                                     const std::vector<double>& x_m,
                                     const std::vector<double>& y_m,
                                     double spacing_m);

/// The same, spaced as the scene's ground_truth.depth_resolution says of the wall.
core::TrueSurface trace_true_surface(const Scene& scene,
                                     const SceneDescription& description,
                                     const core::Transform& world_from_wall,
                                     const std::vector<double>& x_m,
                                     const std::vector<double>& y_m);

/// The same of the whole wall, with its columns.
core::TrueSurface trace_true_surface(const Scene& scene, const SceneDescription& description);

/// A depth map in the wall's own frame, over its whole size, at cell centres.
core::DepthMap trace_ground_truth(const Scene& scene, const SceneDescription& description);

}  // namespace renderer
