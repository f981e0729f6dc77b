// SPDX-License-Identifier: MIT
#include "renderer/gltf/gltf.h"

#include "renderer/core/error.h"
#include "renderer/core/system/process.h"
#include "renderer/gltf/gltf_document.h"
#include "renderer/gltf/gltf_features.h"
#include "renderer/gltf/gltf_material.h"
#include "renderer/gltf/gltf_pose.h"
#include "renderer/gltf/gltf_primitive.h"

#include <fmt/core.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace renderer {
namespace {

core::Transform node_transform(const tinygltf::Node& node, const std::string& where) {
    core::Transform parent_from_node = core::Transform::Identity();
    if (node.matrix.size() == 16) {
        parent_from_node.matrix() = Eigen::Map<const Eigen::Matrix4d>(node.matrix.data());
        if (parent_from_node.matrix().row(3) != Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0)) {
            throw core::Error(where + ".matrix", "is not affine", "its last row must be 0 0 0 1");
        }
        return parent_from_node;
    }
    if (node.translation.size() == 3) {
        parent_from_node.translate(Eigen::Map<const core::Vec3>(node.translation.data()));
    }
    if (node.rotation.size() == 4) {
        const auto& r = node.rotation;
        const Eigen::Quaterniond rotation(r[3], r[0], r[1], r[2]);
        if (!(std::abs(rotation.norm() - 1.0) < 1e-2)) {
            throw core::Error(where + ".rotation",
                              fmt::format("has length {:g}", rotation.norm()),
                              "must be a unit quaternion x, y, z, w");
        }
        parent_from_node.rotate(rotation.normalized());
    }
    if (node.scale.size() == 3) {
        parent_from_node.scale(Eigen::Map<const core::Vec3>(node.scale.data()));
    }
    return parent_from_node;
}

/// What KHR_node_visibility says of a node itself.
bool is_visible(const core::Json& node) {
    return node.value("extensions", core::Json::object())
        .value("KHR_node_visibility", core::Json::object())
        .value("visible", true);
}

constexpr std::size_t kMaxGroups = 8;  // a chain of nodes, each below all before it, stays small

/// Walks the node tree and gathers objects and cameras in world coordinates.
class SceneReader {
 public:
    explicit SceneReader(const GltfDocument& document)
        : document_(document),
          model_(*document.model),
          materials_(document),
          primitives_(document, materials_) {}

    SceneGeometry read() {
        const std::vector<Visit> visits = walk_nodes();
        check_memory(visits);
        geometry_.warnings = document_.warnings;
        world_from_node_.resize(model_.nodes.size());
        for (const Visit& visit : visits) {
            world_from_node_[static_cast<std::size_t>(visit.node)] = visit.world_from_node;
        }
        for (const Visit& visit : visits) {
            const tinygltf::Node& node = model_.nodes[static_cast<std::size_t>(visit.node)];
            if (node.mesh >= 0 && visit.is_visible) add_objects(visit, node.mesh);
            if (node.camera >= 0) add_camera(visit, node.camera);
        }
        if (geometry_.objects.empty()) {
            throw core::Error(document_.path, "has no triangles", "must have at least one");
        }
        return std::move(geometry_);
    }

 private:
    /// A node with its parent's transform and extras until entered, then its own.
    struct Visit {
        int node = 0;
        core::Transform world_from_node = core::Transform::Identity();
        NlosExtras extras;
        bool is_visible = true;
        std::vector<NodeGroup> groups{};
    };

    /// The nodes of the default scene, else of the first one, else all that have no parent.
    std::vector<int> root_nodes() const {
        if (!model_.scenes.empty()) {
            return model_.scenes[static_cast<std::size_t>(std::max(model_.defaultScene, 0))].nodes;
        }
        std::vector<bool> is_child(model_.nodes.size(), false);
        for (const auto& node : model_.nodes) {
            for (const int child : node.children) is_child[static_cast<std::size_t>(child)] = true;
        }
        std::vector<int> roots;
        for (std::size_t i = 0; i < is_child.size(); ++i) {
            if (!is_child[i]) roots.push_back(static_cast<int>(i));
        }
        return roots;
    }

    /// All nodes of the scene, parents first, with their place in the world.
    std::vector<Visit> walk_nodes() const {
        std::vector<Visit> pending;
        for (const int root : root_nodes())
            pending.push_back({root, core::Transform::Identity(), {}, true, {}});
        std::reverse(pending.begin(), pending.end());
        std::vector<Visit> visits;
        std::vector<bool> visited(model_.nodes.size(), false);
        while (!pending.empty()) {
            Visit visit = pending.back();
            pending.pop_back();
            const auto index = static_cast<std::size_t>(visit.node);
            if (visited[index]) {
                throw core::Error(document_.where(fmt::format("nodes[{}]", index)),
                                  "is reached twice (a cycle or two parents)",
                                  "nodes must form trees");
            }
            visited[index] = true;
            enter(visit);
            const auto& children = model_.nodes[index].children;
            const auto groups = groups_below(visit);
            for (auto child = children.rbegin(); child != children.rend(); ++child) {
                pending.push_back(
                    {*child, visit.world_from_node, visit.extras, visit.is_visible, groups});
            }
            visits.push_back(std::move(visit));
        }
        return visits;
    }

    std::vector<NodeGroup> groups_below(const Visit& visit) const {
        std::vector<NodeGroup> groups = visit.groups;
        const std::string& name = model_.nodes[static_cast<std::size_t>(visit.node)].name;
        if (name.empty()) return groups;
        if (groups.size() == kMaxGroups) groups.erase(groups.begin());
        groups.push_back({name, visit.world_from_node});
        return groups;
    }

    void enter(Visit& visit) const {
        const auto index = static_cast<std::size_t>(visit.node);
        const std::string where = document_.where(fmt::format("nodes[{}]", index));
        visit.world_from_node = visit.world_from_node * node_transform(model_.nodes[index], where);
        const core::Json& json = document_.json["nodes"][index];
        visit.extras = read_nlos_extras(json, where).or_else(visit.extras);
        visit.is_visible = visit.is_visible && is_visible(json);
        if (!visit.world_from_node.matrix().allFinite()) {
            throw core::Error(where, "its transform overflows", "must be finite");
        }
    }

    /// Instances can multiply a small file beyond any memory.
    void check_memory(const std::vector<Visit>& visits) {
        constexpr double kBytesPerTriangle = 400.0;  // of facets and of the tree that rays walk
        double bytes = 0.0;
        for (const Visit& visit : visits) {
            const int mesh = model_.nodes[static_cast<std::size_t>(visit.node)].mesh;
            if (mesh < 0) continue;
            const PrimitiveReader::Size size = primitives_.claimed_size(mesh);
            bytes += static_cast<double>(num_instances_of(document_, visit.node)) *
                     (sizeof(Object) + size.bytes + kBytesPerTriangle * size.triangles);
        }
        constexpr double kAlwaysThere = 1e8;  // asking the system takes milliseconds
        if (bytes < kAlwaysThere) return;
        const auto available = static_cast<double>(core::available_memory_bytes());
        if (bytes > available / 2.0) {
            throw core::Error(
                document_.path,
                fmt::format("needs {:.3g} bytes with all its instances", bytes),
                fmt::format("must fit into half of the {:.3g} free bytes", available));
        }
    }

    void add_objects(const Visit& visit, int mesh) {
        const auto index = static_cast<std::size_t>(visit.node);
        const std::string where = document_.where(fmt::format("nodes[{}]", index));
        const tinygltf::Node& node = model_.nodes[index];
        note_features(GltfPart::Node,
                      document_.json["nodes"][index],
                      document_.json,
                      "node " + (node.name.empty() ? std::to_string(index) : node.name),
                      where,
                      geometry_.warnings);
        const std::vector<double> weights = morph_weights(document_, visit.node);
        std::optional<Skin> skin;
        if (node.skin >= 0) skin.emplace(document_, node.skin, world_from_node_);
        const std::vector<core::Transform> instances = instances_of(document_, visit.node);
        for (const Primitive& primitive : primitives_.read(mesh)) {
            add_warnings(primitive.warnings);
            if (primitive.triangles.empty()) continue;
            const std::vector<core::Vec3> positions = morphed_positions(primitive, weights);
            Object object = object_of(primitive, visit);
            if (skin) {
                object.world_from_node = skin->world_from_first_joint();
                object.mesh = posed_mesh(skin->carry(primitive, positions, where),
                                         core::Transform::Identity(),
                                         primitive.triangles,
                                         where);
                geometry_.objects.push_back(std::move(object));
                continue;
            }
            for (const core::Transform& instance : instances) {
                object.world_from_node = visit.world_from_node * instance;
                object.mesh =
                    posed_mesh(positions, object.world_from_node, primitive.triangles, where);
                geometry_.objects.push_back(object);
            }
        }
    }

    /// A node's object, without its mesh and its place.
    Object object_of(const Primitive& primitive, const Visit& visit) {
        const tinygltf::Node& node = model_.nodes[static_cast<std::size_t>(visit.node)];
        const tinygltf::Mesh& mesh = model_.meshes[static_cast<std::size_t>(node.mesh)];
        const LoadedMaterial& loaded = materials_.read(primitive.material);
        const NlosExtras extras = visit.extras.or_else(loaded.extras);
        add_warnings(loaded.warnings);
        Object object;
        object.name = !node.name.empty()   ? node.name
                      : !mesh.name.empty() ? mesh.name
                                           : fmt::format("node{}", visit.node);
        object.material = loaded.material;
        object.material.albedo *= primitive.albedo;
        object.material.model = extras.model_or(object.material.model);
        object.role = extras.role.value_or(Role::Hidden);
        object.ellipsoidal_exclude = extras.ellipsoidal_exclude.value_or(false);
        object.velocity_m_per_s = extras.velocity_m_per_s.value_or(core::Vec3::Zero());
        object.groups = visit.groups;
        object.uv = primitive.uv;
        object.vertex_albedo = primitive.vertex_albedo;
        return object;
    }

    void add_warnings(const std::vector<std::string>& warnings) {
        auto& all = geometry_.warnings;
        for (const std::string& text : warnings) {
            if (std::find(all.begin(), all.end(), text) == all.end()) all.push_back(text);
        }
    }

    void add_camera(const Visit& visit, int camera_index) {
        const tinygltf::Camera& source = model_.cameras[static_cast<std::size_t>(camera_index)];
        if (source.type != "perspective") return;
        const tinygltf::Node& node = model_.nodes[static_cast<std::size_t>(visit.node)];
        const core::Mat3 linear = visit.world_from_node.linear();
        Camera camera;
        camera.name = node.name.empty() ? source.name : node.name;
        camera.position = visit.world_from_node.translation();
        camera.forward = -linear.col(2).normalized();
        camera.up =
            (linear.col(1) - linear.col(1).dot(camera.forward) * camera.forward).normalized();
        camera.fov_y_rad = source.perspective.yfov;
        camera.lens_name = source.name;
        if (!(linear.determinant() != 0.0)) {
            throw core::Error(document_.where(fmt::format("nodes[{}]", visit.node)),
                              "its camera's transform is singular",
                              "must be invertible");
        }
        geometry_.cameras.push_back(std::move(camera));
    }

    const GltfDocument& document_;
    const tinygltf::Model& model_;
    MaterialReader materials_;
    PrimitiveReader primitives_;
    std::vector<std::optional<core::Transform>> world_from_node_;  ///< of those in the scene
    SceneGeometry geometry_;
};

}  // namespace

SceneGeometry load_gltf(const std::string& path) {
    const GltfDocument document = read_gltf_document(path);
    return SceneReader(document).read();
}

}  // namespace renderer
