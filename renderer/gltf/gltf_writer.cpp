// SPDX-License-Identifier: MIT
#include "renderer/core/error.h"
#include "renderer/core/system/output_file.h"
#include "renderer/gltf/gltf.h"
#include "renderer/gltf/gltf_material.h"

#include <fmt/core.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <map>
#include <type_traits>

namespace renderer {
namespace {

/// Appends an item; returns its index, by which other parts of the file refer to it.
template <class T>
int append(std::vector<T>& items, T item) {
    items.push_back(std::move(item));
    return static_cast<int>(items.size()) - 1;
}

/// Collects objects and cameras into a glTF model with one binary buffer.
class ModelBuilder {
 public:
    explicit ModelBuilder(const std::string& path) : path_(path) {
        model_.asset.version = "2.0";
        model_.asset.generator = "nlos";
        model_.scenes.emplace_back();
        model_.defaultScene = 0;
        model_.buffers.emplace_back();
    }

    void add(const Object& object) {
        if (object.mesh.triangles.empty()) fail(object, "has no triangles", "must have one");
        tinygltf::Node node;
        node.name = object.name;
        node.mesh = add_mesh(object);
        node.extras = node_extras(object);
        const int parent = group_node(object.groups);
        set_transform(parent < 0
                          ? object.world_from_node
                          : object.groups.back().world_from_node.inverse() * object.world_from_node,
                      node);
        add_node(std::move(node), parent);
    }

    void add(const Camera& camera) {
        tinygltf::Camera target;
        target.name = camera.name;
        target.type = "perspective";
        target.perspective.yfov = camera.fov_y_rad;
        target.perspective.znear = 0.01;  // glTF wants clipping planes; nothing here uses them
        target.perspective.zfar = 1000.0;

        core::Transform world_from_camera = core::Transform::Identity();
        world_from_camera.translation() = camera.position;
        world_from_camera.linear().col(0) = camera.forward.cross(camera.up);
        world_from_camera.linear().col(1) = camera.up;
        world_from_camera.linear().col(2) = -camera.forward;
        tinygltf::Node node;
        node.name = camera.name;
        node.camera = append(model_.cameras, std::move(target));
        set_transform(world_from_camera, node);
        add_node(std::move(node), /*parent=*/-1);
    }

    const tinygltf::Model& finish() {
        if (model_.buffers[0].data.size() > std::numeric_limits<std::int32_t>::max()) {
            throw core::Error(path_,
                              fmt::format("needs {} bytes", model_.buffers[0].data.size()),
                              "a .glb file of ours holds less than 2 GiB");
        }
        return model_;
    }

 private:
    [[noreturn]] void fail(const Object& object,
                           const std::string& found,
                           const std::string& allowed) const {
        throw core::Error(path_ + ": object " + object.name, found, allowed);
    }

    /// Adds a node below another, or to the scene's own where there is none; returns its index.
    int add_node(tinygltf::Node node, int parent) {
        const int index = append(model_.nodes, std::move(node));
        auto& siblings = parent < 0 ? model_.scenes[0].nodes
                                    : model_.nodes[static_cast<std::size_t>(parent)].children;
        siblings.push_back(index);
        return index;
    }

    /// The node that stands for the innermost of the groups; -1 when there are none.
    int group_node(const std::vector<NodeGroup>& groups) {
        int parent = -1;
        core::Transform group_from_world = core::Transform::Identity();
        for (const NodeGroup& group : groups) {
            const auto known =
                std::find_if(group_nodes_.begin(), group_nodes_.end(), [&](const GroupNode& node) {
                    return node.parent == parent && node.group.name == group.name &&
                           node.group.world_from_node.matrix() == group.world_from_node.matrix();
                });
            if (known != group_nodes_.end()) {
                parent = known->node;
            } else {
                tinygltf::Node node;
                node.name = group.name;
                set_transform(group_from_world * group.world_from_node, node);
                const int index = add_node(std::move(node), parent);
                group_nodes_.push_back({parent, index, group});
                parent = index;
            }
            group_from_world = group.world_from_node.inverse();
        }
        return parent;
    }

    static void set_transform(const core::Transform& parent_from_node, tinygltf::Node& node) {
        if (parent_from_node.linear() != core::Mat3::Identity()) {
            const double* first = parent_from_node.matrix().data();
            node.matrix.assign(first, first + 16);
        } else if (!parent_from_node.translation().isZero(0.0)) {
            const double* first = parent_from_node.matrix().col(3).data();
            node.translation.assign(first, first + 3);
        }
    }

    static tinygltf::Value node_extras(const Object& object) {
        tinygltf::Value::Object extras;
        if (object.role != Role::Hidden) {
            extras.emplace("nlos_role", tinygltf::Value(std::string(core::enum_name(object.role))));
        }
        if (object.ellipsoidal_exclude) {
            extras.emplace("nlos_ellipsoidal_exclude", tinygltf::Value(true));
        }
        if (!object.velocity_m_per_s.isZero(0.0)) {
            const core::Vec3& v = object.velocity_m_per_s;
            extras.emplace("nlos_velocity_m_per_s",
                           tinygltf::Value(tinygltf::Value::Array(v.begin(), v.end())));
        }
        const SurfaceTraits& surface = traits_of(object.material.model);
        if (!surface.gltf || surface.gltf->specular) {
            extras.emplace("nlos_surface_model", tinygltf::Value(std::string(surface.name)));
        } else if (surface.gltf->retroreflective) {
            extras.emplace("nlos_retroreflective", tinygltf::Value(true));
        }
        return extras.empty() ? tinygltf::Value() : tinygltf::Value(std::move(extras));
    }

    int add_mesh(const Object& object) {
        tinygltf::Primitive primitive;
        primitive.mode = TINYGLTF_MODE_TRIANGLES;
        primitive.material = add_material(object);
        primitive.attributes["POSITION"] = add_positions(object);
        if (!object.uv.empty()) primitive.attributes["TEXCOORD_0"] = add_uv(object);
        if (!object.vertex_albedo.empty()) primitive.attributes["COLOR_0"] = add_colours(object);
        primitive.indices = add_indices(object.mesh);
        tinygltf::Mesh mesh;
        mesh.name = object.name;
        mesh.primitives.push_back(std::move(primitive));
        return append(model_.meshes, std::move(mesh));
    }

    int add_material(const Object& object) {
        const Material& material = object.material;
        const auto is_fraction = [](double value) { return value >= 0.0 && value <= 1.0; };
        if (!is_fraction(material.albedo) || !is_fraction(material.roughness)) {
            fail(object,
                 fmt::format("has albedo {} and roughness {}", material.albedo, material.roughness),
                 "must be from 0 to 1");
        }
        tinygltf::Material target;
        target.name = material.name;
        auto& pbr = target.pbrMetallicRoughness;
        pbr.baseColorFactor = {material.albedo, material.albedo, material.albedo, 1.0};
        pbr.metallicFactor =
            traits_of(material.model).gltf.value_or(GltfSurface{}).metallic ? 1.0 : 0.0;
        pbr.roughnessFactor = material.roughness;
        if (material.albedo_texture) {
            if (object.uv.empty()) {
                fail(object, "has a texture and no texture coordinates", "needs both");
            }
            pbr.baseColorTexture.index = add_texture(material.albedo_texture.get());
        }
        return append(model_.materials, std::move(target));
    }

    int add_texture(const Texture* texture) {
        const auto found = textures_.find(texture);
        if (found != textures_.end()) return found->second;
        tinygltf::Image image;
        image.mimeType = "image/png";
        image.width = texture->width;
        image.height = texture->height;
        image.component = 1;
        image.bits = 8;
        image.pixel_type = TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE;
        for (const float value : texture->luminance) {
            const double encoded = srgb_from_linear(static_cast<double>(value));
            image.image.push_back(static_cast<unsigned char>(std::lround(255.0 * encoded)));
        }
        tinygltf::Sampler sampler;
        sampler.wrapS = kGltfWraps[static_cast<std::size_t>(texture->wrap_u)];
        sampler.wrapT = kGltfWraps[static_cast<std::size_t>(texture->wrap_v)];
        tinygltf::Texture target;
        target.source = append(model_.images, std::move(image));
        target.sampler = append(model_.samplers, std::move(sampler));
        return textures_.emplace(texture, append(model_.textures, std::move(target))).first->second;
    }

    int add_positions(const Object& object) {
        const core::Transform node_from_world = object.world_from_node.inverse();
        std::vector<float> values;
        core::Vec3 low = core::Vec3::Constant(std::numeric_limits<double>::infinity());
        core::Vec3 high = -low;
        for (const core::Vec3& vertex : object.mesh.vertices) {
            const Eigen::Vector3f position = (node_from_world * vertex).cast<float>();
            if (!position.allFinite()) {
                fail(object,
                     "has a vertex or transform that cannot be stored",
                     "vertices must be finite floats in the node's frame");
            }
            values.insert(values.end(), position.begin(), position.end());
            low = low.cwiseMin(position.cast<double>());
            high = high.cwiseMax(position.cast<double>());
        }
        const int index = add_accessor(values, TINYGLTF_TYPE_VEC3);
        model_.accessors.back().minValues.assign(low.begin(), low.end());
        model_.accessors.back().maxValues.assign(high.begin(), high.end());
        return index;
    }

    int add_uv(const Object& object) {
        if (object.uv.size() != object.mesh.vertices.size()) {
            fail(object,
                 fmt::format("has {} vertices and {} texture coordinates",
                             object.mesh.vertices.size(),
                             object.uv.size()),
                 "must be as many");
        }
        std::vector<float> values;
        for (const core::Vec2& uv : object.uv) {
            values.push_back(static_cast<float>(uv.x()));
            values.push_back(static_cast<float>(uv.y()));
        }
        return add_accessor(values, TINYGLTF_TYPE_VEC2);
    }

    int add_colours(const Object& object) {
        std::vector<float> values;
        for (const double albedo : object.vertex_albedo) {
            values.insert(values.end(), 3, static_cast<float>(albedo));
        }
        return add_accessor(values, TINYGLTF_TYPE_VEC3);
    }

    int add_indices(const core::TriangleMesh& mesh) {
        // The largest value of a type is reserved (primitive restart, [glTF2] 3.7.2.1).
        return mesh.vertices.size() < std::numeric_limits<std::uint16_t>::max()
                   ? add_indices_as<std::uint16_t>(mesh)
                   : add_indices_as<std::uint32_t>(mesh);
    }

    template <class Index>
    int add_indices_as(const core::TriangleMesh& mesh) {
        std::vector<Index> values;
        for (const auto& triangle : mesh.triangles) {
            for (const std::uint32_t v : triangle) values.push_back(static_cast<Index>(v));
        }
        return add_accessor(values, TINYGLTF_TYPE_SCALAR);
    }

    /// Appends vertex data (floats) or indices to the buffer, on a 4-byte boundary, with a view and
    /// an accessor of their own.
    template <class T>
    int add_accessor(const std::vector<T>& values, int type) {
        constexpr bool kIsVertexData = std::is_floating_point_v<T>;
        std::vector<unsigned char>& bytes = model_.buffers[0].data;
        bytes.resize((bytes.size() + 3) / 4 * 4);
        tinygltf::BufferView view;
        view.buffer = 0;
        view.byteOffset = bytes.size();
        view.byteLength = values.size() * sizeof(T);
        view.target =
            kIsVertexData ? TINYGLTF_TARGET_ARRAY_BUFFER : TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER;
        bytes.resize(bytes.size() + view.byteLength);
        std::memcpy(bytes.data() + view.byteOffset, values.data(), view.byteLength);

        tinygltf::Accessor accessor;
        accessor.bufferView = append(model_.bufferViews, std::move(view));
        accessor.componentType = kIsVertexData    ? TINYGLTF_COMPONENT_TYPE_FLOAT
                                 : sizeof(T) == 2 ? TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT
                                                  : TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
        accessor.type = type;
        accessor.count =
            values.size() /
            static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<uint32_t>(type)));
        return append(model_.accessors, std::move(accessor));
    }

    struct GroupNode {
        int parent;  ///< -1: none
        int node;
        NodeGroup group;
    };

    const std::string& path_;
    tinygltf::Model model_;
    std::vector<GroupNode> group_nodes_;
    std::map<const Texture*, int> textures_;
};

}  // namespace

void write_gltf(const std::string& path, const SceneGeometry& geometry) {
    if (geometry.objects.empty()) throw core::Error(path, "no objects to write", "needs one");
    ModelBuilder builder(path);
    for (const Object& object : geometry.objects) builder.add(object);
    for (const Camera& camera : geometry.cameras) builder.add(camera);

    core::OutputFile output(path);
    std::ofstream stream(output.temporary(), std::ios::binary);
    tinygltf::TinyGLTF writer;
    writer.WriteGltfSceneToStream(
        &builder.finish(), stream, /*prettyPrint=*/false, /*writeBinary=*/true);
    stream.close();
    if (!stream) throw core::Failure(path, "cannot be written (disk full?)");
    output.commit();
}

}  // namespace renderer
