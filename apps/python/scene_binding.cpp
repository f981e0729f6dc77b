// SPDX-License-Identifier: MIT
#include "apps/python/bindings.h"
#include "apps/python/wall_frame_binding.h"
#include "apps/scene_truth.h"
#include "renderer/core/settings/settings_json.h"
#include "renderer/core/system/output_file.h"
#include "renderer/gltf/gltf.h"
#include "renderer/scene/load_geometry.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <filesystem>

namespace python {
namespace {

namespace nb = nanobind;

std::vector<std::array<std::uint32_t, 3>> faces_from(nb::handle value, std::size_t num_vertices) {
    const auto faces = nb::cast<IndexArray>(numbers_from(value, "int64", "faces"));
    if (faces.ndim() != 2 || faces.shape(1) != 3) {
        throw core::Error(
            "faces", "has shape " + shape_text(shape_of(faces)), "must have shape (M, 3)");
    }
    std::vector<std::array<std::uint32_t, 3>> triangles(faces.shape(0));
    for (std::size_t i = 0; i < faces.size(); ++i) {
        const std::int64_t vertex = faces.data()[i];
        if (vertex < 0 || vertex >= static_cast<std::int64_t>(num_vertices)) {
            throw core::Error("faces",
                              "found vertex " + std::to_string(vertex),
                              "must be from 0 to " + std::to_string(num_vertices) + " - 1");
        }
        triangles[i / 3][i % 3] = static_cast<std::uint32_t>(vertex);
    }
    return triangles;
}

void drop_triangles_without_area(core::TriangleMesh& mesh) {
    std::erase_if(mesh.triangles, [&](const std::array<std::uint32_t, 3>& t) {
        const core::Vec3& corner = mesh.vertices[t[0]];
        return !core::has_area(mesh.vertices[t[1]] - corner, mesh.vertices[t[2]] - corner);
    });
    if (mesh.triangles.empty()) {
        throw core::Error("faces", "holds no triangle with an area", "must hold one");
    }
}

/// How an object that is made from arrays reflects and moves.
struct ObjectFields {
    renderer::Object& object;
};

template <class Visitor>
void for_each_field(ObjectFields& s, Visitor&& visit) {
    renderer::Material& material = s.object.material;
    visit("name", s.object.name, "of the object");
    visit("albedo", material.albedo, core::between(0, 1, "fraction of light that is reflected"));
    visit("surface", material.model, "how it reflects");
    visit("roughness", material.roughness, core::between(0, 1, "of models with a lobe"));
    visit("role", s.object.role, "what it is to the measurement");
    visit("velocity_m_per_s", s.object.velocity_m_per_s, "world [m/s]");
}

renderer::Object make_object(nb::handle vertices, nb::handle faces, const nb::kwargs& keywords) {
    renderer::Object object;
    object.name = "object";
    core::check_ranges(settings_from_python(keywords, ObjectFields{object}), "");
    object.mesh.vertices = vectors_from(vertices, "vertices");
    object.mesh.triangles = faces_from(faces, object.mesh.vertices.size());
    drop_triangles_without_area(object.mesh);
    return object;
}

SceneObject with_objects(SceneObject scene, const std::vector<renderer::Object>& objects) {
    if (objects.empty()) throw core::Error("objects", "found none", "must be one at least");
    scene.description.objects.clear();  // objects say themselves what they are
    scene.geometry.objects = objects;
    return scene;
}

SceneObject make_scene(const std::vector<renderer::Object>& objects, const nb::kwargs& settings) {
    SceneObject scene = with_objects({}, objects);
    scene.name = "scene";
    scene.description.geometry = "objects";  // as messages call what is no file
    change_scene(scene, json_from_python(settings, ""));
    return scene;
}

SceneObject load_scene(const std::string& path, const nb::dict& settings) {
    SceneObject scene;
    scene.name = std::filesystem::absolute(path).lexically_normal().string();
    const core::Json changes = json_from_python(settings, "");
    with_files([&] {
        scene.description = renderer::read_scene_description(path, {});
        scene.geometry = renderer::load_geometry(scene.description);
    });
    change_scene(scene, changes);
    return scene;
}

nb::dict depth_map(const SceneObject& scene) {
    core::DepthMap map = run_long(nb::none(), 0, [&](const core::Progress&) {
        return apps::SceneTruth(scene.description, scene.geometry).depth_map();
    });
    const Extents shape{map.x_m.size(), map.y_m.size()};
    nb::dict result;
    result["x_m"] = array_of(std::move(map.x_m), {shape[0]});
    result["y_m"] = array_of(std::move(map.y_m), {shape[1]});
    result["depth_m"] = array_of(std::move(map.depth_m), shape);
    result["world_from_wall"] = matrix_of(map.world_from_wall);
    if (!map.albedo.empty()) result["albedo"] = array_of(std::move(map.albedo), shape);
    return result;
}

void write_scene(const SceneObject& scene, nb::handle target) {
    const std::string path = path_from(target);
    const auto geometry = std::filesystem::path(path).replace_extension(".glb");
    core::check_targets({path, geometry.string()}, {});
    renderer::SceneDescription description = scene.description;
    renderer::refer_to_gltf(geometry.filename().string(), description);
    core::Json json = core::write_value(description);
    if (description.camera) {
        json.erase("relay_wall");
        json.erase("scan");
    }
    renderer::write_gltf(geometry.string(), scene.geometry);
    core::write_text_file(path, core::json_text(json));
}

void bind_object(nb::module_& module) {
    nb::class_<renderer::Object>(module, "Object", "A triangle mesh of one material.")
        .def("__init__",
             constructor(&make_object),
             nb::arg("vertices").none(),
             nb::arg("faces").none(),
             nb::arg("fields"))
        .def_ro("name", &renderer::Object::name)
        .def_prop_ro(
            "vertices",
            [](nb::handle self) {
                auto& vertices = nb::cast<renderer::Object&>(self).mesh.vertices;
                return array_view(vertices, {vertices.size()}, self);
            },
            "(N, 3) float64, world [m]")
        .def_prop_ro(
            "faces",
            [](const renderer::Object& o) { return array_of(o.mesh.triangles); },
            nb::rv_policy::reference,
            "(M, 3) uint32, indices of vertices")
        .def_prop_ro("albedo", [](const renderer::Object& o) { return o.material.albedo; })
        .def_prop_ro("surface",
                     [](const renderer::Object& o) {
                         return std::string(core::enum_name(o.material.model));
                     })
        .def_prop_ro(
            "role", [](const renderer::Object& o) { return std::string(core::enum_name(o.role)); });
}

}  // namespace

void change_scene(SceneObject& scene, const core::Json& changes) {
    renderer::change_description(scene.description, changes);
    renderer::apply_objects(scene.description, scene.geometry);
}

ScannedScene scan_scene(const SceneObject& scene,
                        const nb::object& scan,
                        const nb::object& axis,
                        core::Json changes) {
    const core::Capture* like = nullptr;
    if (nb::isinstance<core::Capture>(scan)) {
        like = &nb::cast<core::Capture&>(scan);
    } else if (!scan.is_none()) {
        changes["scan"] = json_from_python(scan, "scan");
    }
    if (!axis.is_none()) changes["time_axis"] = json_from_python(axis, "axis");
    ScannedScene scanned{scene, {}};
    change_scene(scanned.scene, changes);
    if (like == nullptr) {
        scanned.scan = renderer::make_scan(scanned.scene.description);
        return scanned;
    }
    scanned.scan = like->scan;
    if (const auto* wall = like->scan.as<core::WallScan>()) {
        renderer::describe_scan(*wall, scanned.scene.description.scan);
    }
    if (axis.is_none()) scanned.scene.description.time_axis = {like->time_axis};
    return scanned;
}

void bind_scene(nb::module_& module) {
    bind_object(module);
    nb::class_<SceneObject>(module, "Scene", "Objects, a relay wall or camera, and how to render.")
        .def("__init__", constructor(&make_scene), nb::arg("objects"), nb::arg("settings"))
        .def_prop_ro(
            "objects",
            [](const SceneObject& scene) { return scene.geometry.objects; },
            "list of Object; copies")
        .def_prop_ro(
            "settings",
            [](const SceneObject& scene) {
                return python_from_json(core::write_value(scene.description));
            },
            "all keys of scene.json with their values")
        .def_ro("name", &SceneObject::name)
        .def(
            "changed",
            [](const SceneObject& scene, const nb::kwargs& settings) {
                SceneObject changed = scene;
                change_scene(changed, json_from_python(settings, ""));
                return changed;
            },
            nb::arg("settings"),
            "A copy with other settings.")
        .def("with_objects", &with_objects, nb::arg("objects"), "A copy with other objects.")
        .def("depth_map",
             &depth_map,
             "What the relay wall sees, in its frame: dict of x_m (X,) and y_m (Y,) along wall x "
             "and wall y, depth_m (X, Y) from the wall with NaN for background [m], "
             "world_from_wall (4, 4), and albedo (X, Y) where known.")
        .def("write",
             &write_scene,
             nb::arg("path").none(),
             "Writes scene.json, and the geometry beside it (.glb), for the program.");
    module.def("load_scene", &load_scene, nb::arg("path"), nb::arg("settings"));
}

}  // namespace python
