// SPDX-License-Identifier: MIT
#include "renderer/gltf/gltf_pose.h"

#include "renderer/core/error.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace renderer {
namespace {

using core::Json;
using core::Transform;
using core::Vec3;

const Json* node_extension(const GltfDocument& document, int node, const char* name) {
    const Json& json = document.json["nodes"][static_cast<std::size_t>(node)];
    const auto extensions = json.find("extensions");
    if (extensions == json.end() || !extensions->is_object()) return nullptr;
    const auto extension = extensions->find(name);
    return extension == extensions->end() ? nullptr : &*extension;
}

// The lists of EXT_mesh_gpu_instancing, by accessor; null where the node has none.
const Json* instance_lists(const GltfDocument& document, int node) {
    const Json* extension = node_extension(document, node, "EXT_mesh_gpu_instancing");
    if (extension == nullptr || !extension->is_object()) return nullptr;
    const auto lists = extension->find("attributes");
    return lists == extension->end() || lists->empty() ? nullptr : &*lists;
}

}  // namespace

std::vector<Vec3> morphed_positions(const Primitive& primitive,
                                    const std::vector<double>& weights) {
    std::vector<Vec3> positions = primitive.positions;
    for (std::size_t t = 0; t < std::min(weights.size(), primitive.morphs.size()); ++t) {
        if (weights[t] == 0.0) continue;
        const std::vector<Vec3>& ways = primitive.morphs[t];
        for (std::size_t v = 0; v < ways.size(); ++v) positions[v] += weights[t] * ways[v];
    }
    return positions;
}

std::vector<double> morph_weights(const GltfDocument& document, int node) {
    const Json& json = document.json["nodes"][static_cast<std::size_t>(node)];
    if (json.contains("weights")) return json["weights"].get<std::vector<double>>();
    const Json& mesh = document.json["meshes"][json["mesh"].get<std::size_t>()];
    if (mesh.contains("weights")) return mesh["weights"].get<std::vector<double>>();
    return {};
}

std::size_t num_instances_of(const GltfDocument& document, int node) {
    const Json* lists = instance_lists(document, node);
    return lists == nullptr ? 1 : checked_count(document, lists->begin()->get<int>());
}

std::vector<Transform> instances_of(const GltfDocument& document, int node) {
    const Json* lists = instance_lists(document, node);
    if (lists == nullptr) return {Transform::Identity()};
    const std::string where =
        document.where(fmt::format("nodes[{}].extensions.EXT_mesh_gpu_instancing", node));
    std::vector<Transform> instances(num_instances_of(document, node), Transform::Identity());
    // Each list may be missing. They are read one after another, in the order of their effect.
    const auto for_each = [&](const char* name, const auto& read, const auto& apply) {
        const auto list = lists->find(name);
        if (list == lists->end()) return;
        const auto values = read(document, list->template get<int>());
        if (values.size() != instances.size()) {
            throw core::Error(
                where,
                fmt::format("has {} {} and {} others", values.size(), name, instances.size()),
                "must be as many");
        }
        for (std::size_t i = 0; i < values.size(); ++i) apply(instances[i], values[i]);
    };
    for_each("TRANSLATION", read_positions, [](Transform& transform, const Vec3& way) {
        transform.translate(way);
    });
    for_each("ROTATION", read_vectors4, [&](Transform& transform, const Eigen::Vector4d& r) {
        const Eigen::Quaterniond rotation(r[3], r[0], r[1], r[2]);
        if (!(std::abs(rotation.norm() - 1.0) < 1e-2)) {
            throw core::Error(where + ".attributes.ROTATION",
                              fmt::format("has one of length {:g}", rotation.norm()),
                              "must be unit quaternions x, y, z, w");
        }
        transform.rotate(rotation.normalized());
    });
    for_each("SCALE", read_positions, [](Transform& transform, const Vec3& scale) {
        transform.scale(scale);
    });
    return instances;
}

Skin::Skin(const GltfDocument& document,
           int skin,
           const std::vector<std::optional<Transform>>& world_from_node) {
    const std::string where = document.where(fmt::format("skins[{}]", skin));
    const Json& json = document.json["skins"][static_cast<std::size_t>(skin)];
    std::vector<Eigen::Matrix4d> joint_from_bound;
    if (json.contains("inverseBindMatrices")) {
        joint_from_bound = read_matrices(document, json["inverseBindMatrices"].get<int>());
    }
    const Json& joints = json["joints"];
    if (!joint_from_bound.empty() && joint_from_bound.size() < joints.size()) {
        throw core::Error(where + ".inverseBindMatrices",
                          fmt::format("has {} matrices", joint_from_bound.size()),
                          fmt::format("must have one for each of {} joints", joints.size()));
    }
    for (std::size_t i = 0; i < joints.size(); ++i) {
        const auto& joint = world_from_node[joints[i].get<std::size_t>()];
        if (!joint) {
            throw core::Error(where + ".joints",
                              fmt::format("names node {}, which is not in the scene",
                                          joints[i].get<std::size_t>()),
                              "must name nodes of the scene");
        }
        if (i == 0) world_from_first_joint_ = *joint;
        world_from_bound_.push_back(joint->matrix());
        if (!joint_from_bound.empty()) world_from_bound_.back() *= joint_from_bound[i];
    }
}

std::vector<Vec3> Skin::carry(const Primitive& primitive,
                              const std::vector<Vec3>& positions,
                              const std::string& where) const {
    if (primitive.influences.empty()) {
        throw core::Error(
            where, "has a skin and a mesh without JOINTS_0 and WEIGHTS_0", "must have both");
    }
    std::vector<Vec3> carried;
    carried.reserve(positions.size());
    for (std::size_t v = 0; v < positions.size(); ++v) {
        Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
        double weights = 0.0;
        for (const std::vector<Influences>& set : primitive.influences) {
            for (const auto& [joint, weight] : set[v]) {
                if (weight == 0.0) continue;
                if (joint >= world_from_bound_.size()) {
                    throw core::Error(
                        where,
                        fmt::format("has a vertex of joint {}", joint),
                        fmt::format("its skin has {} joints", world_from_bound_.size()));
                }
                sum += weight * world_from_bound_[joint];
                weights += weight;
            }
        }
        if (!(weights > 0.0)) {
            throw core::Error(
                where, fmt::format("vertex {} belongs to no joint", v), "must have a weight");
        }
        carried.push_back((sum * positions[v].homogeneous()).head<3>() / weights);
    }
    return carried;
}

core::TriangleMesh posed_mesh(const std::vector<Vec3>& positions,
                              const Transform& world_from_positions,
                              const std::vector<Triangle>& triangles,
                              const std::string& where) {
    core::TriangleMesh mesh;
    mesh.vertices.reserve(positions.size());
    for (const Vec3& position : positions) {
        mesh.vertices.push_back(world_from_positions * position);
        if (!mesh.vertices.back().allFinite()) {
            throw core::Error(where, "its vertices overflow", "must be finite");
        }
    }
    // A mirroring transform turns front faces over; keeping them in front is glTF's rule.
    const core::Mat3 linear = world_from_positions.linear();
    const bool mirrored = linear.determinant() < 0.0;
    for (const auto& [a, b, c] : triangles) {
        // Edges are transformed on their own: differences of far world points lose digits.
        const Vec3 ab = linear * (positions[b] - positions[a]);
        const Vec3 ac = linear * (positions[c] - positions[a]);
        if (!core::has_area(ab, ac)) continue;
        mesh.triangles.push_back(mirrored ? Triangle{a, c, b} : Triangle{a, b, c});
    }
    if (mesh.triangles.empty()) {
        throw core::Error(where, "its mesh has no triangle with an area", "must have one");
    }
    return mesh;
}

}  // namespace renderer
