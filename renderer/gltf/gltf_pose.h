// SPDX-License-Identifier: MIT
#pragma once

#include "renderer/core/mesh.h"
#include "renderer/gltf/gltf_document.h"
#include "renderer/gltf/gltf_primitive.h"

#include <optional>
#include <vector>

namespace renderer {

/// Vertices of a primitive where morph targets put them, node coordinates.
///
/// weights   of the targets; those that are missing are 0
std::vector<core::Vec3> morphed_positions(const Primitive& primitive,
                                          const std::vector<double>& weights);

/// The weights of morph targets of a node: its own, else its mesh's.
std::vector<double> morph_weights(const GltfDocument& document, int node);

/// Where a node shows its mesh, relative to itself: once, or as often as EXT_mesh_gpu_instancing
/// says. Throws core::Error when its lists differ in length or hold no rotations.
std::vector<core::Transform> instances_of(const GltfDocument& document, int node);
/// How many these are, without looking at them.
std::size_t num_instances_of(const GltfDocument& document, int node);

/// A mesh in world coordinates, without triangles that have no area.
///
/// where    names the node in messages
/// throws   core::Error when vertices overflow, or no triangle is left
core::TriangleMesh posed_mesh(const std::vector<core::Vec3>& positions,
                              const core::Transform& world_from_positions,
                              const std::vector<Triangle>& triangles,
                              const std::string& where);

/// Joints that carry vertices with them.
class Skin {
 public:
    /// world_from_node   of every node of the file; nothing for nodes that the scene lacks
    /// throws            core::Error when a joint is none of the scene's nodes, or matrices are
    /// wrong
    Skin(const GltfDocument& document,
         int skin,
         const std::vector<std::optional<core::Transform>>& world_from_node);

    /// Where the joint that is listed first stands.
    const core::Transform& world_from_first_joint() const { return world_from_first_joint_; }

    /// Positions in the world of a primitive's vertices.
    ///
    /// positions   node coordinates
    /// where       names the node in messages
    /// throws      core::Error when the primitive says of no joints, or of others
    std::vector<core::Vec3> carry(const Primitive& primitive,
                                  const std::vector<core::Vec3>& positions,
                                  const std::string& where) const;

 private:
    std::vector<Eigen::Matrix4d> world_from_bound_;  ///< per joint
    core::Transform world_from_first_joint_;
};

}  // namespace renderer
